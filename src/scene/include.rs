//! `include`: files of definitions that count as if they stood in the scene.
//!
//! Names are relative to the folder of the file that names them. Symbolic links are followed before it
//! is asked whether a file lies in the folder of the scene, or below: a scene from a stranger shall
//! not quote any file. Each file is read once, by whatever names it is known.

use std::{
    fs,
    path::{Path, PathBuf},
};

use toml::de::{DeTable, DeValue};

use super::{
    definitions::Named,
    read::{check_version, file_names, names, syntax},
    spanned::Spanned,
    spec::SceneSpec,
};
use crate::{
    diagnostic::{Diagnostic, Model, Origin},
    files,
};

/// More files than this are no scene written by hand.
const MAX_FILES: usize = 64;

/// The most that one file holds.
const MAX_BYTES: u64 = 4 << 20;

/// What is included by a scene.
pub(super) struct Includes<'a> {
    /// The scene's folder, if it has one.
    folder: Option<&'a Path>,
    allow_outside: bool,
    /// The files whose includes are being read, the scene first: their places and what to call them.
    open: Vec<(PathBuf, String)>,
    files: Vec<Model>,
    /// Where the files are that were read.
    places: Vec<PathBuf>,
    params: Named,
    lets: Named,
    shapes: Named,
}

impl<'a> Includes<'a> {
    /// For the scene in the file `path`, whose folder is `folder`.
    pub(super) fn new(path: &Path, folder: Option<&'a Path>, allow_outside: bool) -> Self {
        let name = path.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned());
        let place = folder.and_then(|folder| fs::canonicalize(folder.join(&name)).ok());
        let open = vec![(place.unwrap_or_default(), name)];
        Self {
            folder,
            allow_outside,
            open,
            files: Vec::new(),
            places: Vec::new(),
            params: Named::default(),
            lets: Named::default(),
            shapes: Named::default(),
        }
    }

    /// Reads all that the scene includes, puts it into `spec` and returns the files. Parameters of the
    /// scene take the place of included ones.
    pub(super) fn read(mut self, spec: &mut SceneSpec, errors: &mut Vec<Diagnostic>) -> Vec<Model> {
        let folder = self.folder.map(Path::to_owned);
        for name in &spec.include {
            self.file(name, folder.as_deref(), Origin::File, errors);
        }
        spec.params.include(self.params.without(&spec.params));
        spec.lets.include(self.lets);
        spec.shapes.include(self.shapes);
        self.files
    }

    /// Reads the file that the text `origin` in `folder` names.
    fn file(
        &mut self,
        name: &Spanned<String>,
        folder: Option<&Path>,
        origin: Origin,
        errors: &mut Vec<Diagnostic>,
    ) {
        let mut refuse = |mistake: Diagnostic| errors.push(Diagnostic { origin, ..mistake });
        let (path, place) = match self.place(name, folder) {
            Ok(found) => found,
            Err(mistake) => return refuse(mistake),
        };
        if let Some(first) = self.open.iter().position(|(open, _)| *open == place) {
            let chain: Vec<&str> = self.open[first..].iter().map(|(_, name)| &**name).collect();
            let circle = format!("{} -> {}", chain.join(" -> "), chain[0]);
            return refuse(
                Diagnostic::new(name.span(), format!("`{}` includes itself: {circle}", chain[0]))
                    .label("this closes the circle")
                    .help("move what both need to a file of its own"),
            );
        }
        if self.places.contains(&place) {
            return;
        }
        if self.files.len() == MAX_FILES {
            let message = format!("the scene includes more than {MAX_FILES} files");
            return refuse(Diagnostic::new(name.span(), message));
        }
        let bytes = match files::read(&place, MAX_BYTES) {
            Ok(Some(bytes)) => bytes,
            Ok(None) => {
                let message = format!("{} is larger than {} MiB", path.display(), MAX_BYTES >> 20);
                return refuse(Diagnostic::new(name.span(), message));
            }
            Err(error) => {
                let message = format!("cannot read {}: {error}", path.display());
                return refuse(Diagnostic::new(name.span(), message));
            }
        };
        let (text, mistake) = files::decode(bytes);
        let inner = Origin::Model(self.files.len());
        self.files.push(Model { path: path.clone(), text: text.clone() });
        self.places.push(place.clone());
        self.open.push((place, name.get_ref().clone()));
        let mut mistakes: Vec<Diagnostic> = mistake.into_iter().collect();
        let names = match mistakes.is_empty() {
            true => self.definitions(&text, inner, &mut mistakes),
            false => Vec::new(),
        };
        errors.extend(mistakes.into_iter().map(|mistake| Diagnostic { origin: inner, ..mistake }));
        for name in names {
            self.file(&name, path.parent(), inner, errors);
        }
        self.open.pop();
    }

    /// Takes what the file defines and returns the names of the files that it includes itself.
    fn definitions(
        &mut self,
        text: &str,
        origin: Origin,
        errors: &mut Vec<Diagnostic>,
    ) -> Vec<Spanned<String>> {
        let (root, mistakes) = DeTable::parse_recoverable(text);
        if !mistakes.is_empty() {
            errors.extend(mistakes.iter().map(|mistake| syntax(mistake, text)));
            return Vec::new();
        }
        let root = root.into_inner();
        if let Err(error) = check_version(&root) {
            errors.push(error);
            return Vec::new();
        }
        let mut included = Vec::new();
        for (key, value) in root {
            let mut read = |section: &str, value: toml::Spanned<DeValue<'_>>| {
                names(section, value, text, errors).in_text(origin)
            };
            match key.get_ref().as_ref() {
                "version" => {}
                "params" => self.params.include(read("[params]", value)),
                "let" => self.lets.include(read("[let]", value)),
                "shapes" => self.shapes.include(read("[shapes]", value).into_shapes()),
                "include" => included = file_names(value, errors),
                other => errors.push(
                    Diagnostic::new(key.span(), format!("`{other}` stands in an included file"))
                        .label("only definitions are taken from here")
                        .help("included files have [params], [let], [shapes] and `include`"),
                ),
            }
        }
        included
    }

    /// Where the file is: as it is named, and without links.
    fn place(
        &self,
        name: &Spanned<String>,
        folder: Option<&Path>,
    ) -> Result<(PathBuf, PathBuf), Diagnostic> {
        let mistake = |message: String| Diagnostic::new(name.span(), message);
        let (Some(root), Some(folder)) = (self.folder, folder) else {
            return Err(mistake("a scene without a folder includes a file".to_owned())
                .label("relative to which folder?")
                .help("read the scene from a file, or say in which folder its files are"));
        };
        if Path::new(name.get_ref()).extension().is_none_or(|ending| ending != "toml") {
            return Err(mistake("the name must end in `.toml`".to_owned())
                .label("not a file of definitions"));
        }
        let path = folder.join(name.get_ref());
        let failed = |why: String| {
            mistake(format!("cannot include {}: {why}", path.display()))
                .help("the name is relative to the folder of the file that names it")
        };
        let place = fs::canonicalize(&path).map_err(|error| failed(reason(&error)))?;
        let root = if root.as_os_str().is_empty() { Path::new(".") } else { root };
        let root = fs::canonicalize(root).map_err(|error| failed(reason(&error)))?;
        if !self.allow_outside && !place.starts_with(&root) {
            return Err(mistake(format!("{} lies outside the scene's folder", path.display()))
                .label("not included")
                .help("move it into the folder, or allow it with --allow-outside"));
        }
        if !place.is_file() {
            return Err(failed("it is not a file".to_owned()));
        }
        Ok((path, place))
    }
}

fn reason(error: &std::io::Error) -> String {
    match error.kind() {
        std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
        _ => error.to_string(),
    }
}
