//! Files that are either complete or not there.
//!
//! *Invariant:* under the target's name there is at any moment what was there before or the whole
//! new file. The bytes go to a nameless neighbour in the same folder, which takes the name in one
//! step; if anything fails on the way, or the program stops, nothing is left behind.

use std::{
    fs::{self, File},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use tempfile::{Builder, NamedTempFile, TempPath};

use super::{WriteError, Written};
use crate::{Error, Result};

/// What a format writes to when it writes to a file.
pub type FileWriter = BufWriter<File>;

/// Bytes that are gathered before they go to the file; formats write in small pieces.
pub(super) const BUFFER_BYTES: usize = 1 << 16;

/// Writes the file at `path` with `write`, replacing what is there. Folders that are missing on the
/// way to it are created.
///
/// # Errors
/// [`Error::Io`] if a folder or the file cannot be created, written or named, [`Error::Encode`] if
/// `write` says that the data does not fit the format.
pub fn write_file(path: &Path, write: impl FnOnce(&mut FileWriter) -> Written) -> Result<()> {
    let mut file = NewFile::create(path)?;
    write(file.writer()).map_err(|error| failed_to_write(path, error))?;
    file.keep()
}

/// A file that is written little by little. Unless it is kept, it vanishes and the old one stays.
#[derive(Debug)]
pub struct NewFile {
    path: PathBuf,
    out: FileWriter,
    unnamed: TempPath,
}

impl NewFile {
    /// Begins the file at `path`. Folders that are missing on the way to it are created.
    ///
    /// # Errors
    /// [`Error::Io`] if a folder or the file cannot be created.
    pub fn create(path: &Path) -> Result<Self> {
        let folder = match path.parent() {
            Some(folder) if folder != Path::new("") => folder,
            _ => Path::new("."),
        };
        fs::create_dir_all(folder).map_err(failed("create", folder))?;
        let (file, unnamed) = new_file(folder).map_err(failed("create", path))?.into_parts();
        let out = BufWriter::with_capacity(BUFFER_BYTES, file);
        Ok(Self { path: path.to_owned(), out, unnamed })
    }

    /// Where its bytes go.
    pub fn writer(&mut self) -> &mut FileWriter {
        &mut self.out
    }

    /// Gives the file its name, in place of what was there.
    ///
    /// # Errors
    /// [`Error::Io`] if its last bytes cannot be written, or it cannot be named.
    pub fn keep(self) -> Result<()> {
        let Self { path, mut out, unnamed } = self;
        out.flush().map_err(failed("write", &path))?;
        // Windows cannot rename a file that is open.
        drop(out);
        unnamed.persist(&path).map_err(|error| failed("write", &path)(error.error))
    }
}

fn failed(action: &'static str, path: &Path) -> impl FnOnce(io::Error) -> Error {
    let path = path.to_owned();
    move |source| Error::Io { action, path, source }
}

/// That the file at `path` was not written.
pub(crate) fn failed_to_write(path: &Path, error: WriteError) -> Error {
    match error {
        WriteError::Io(source) => failed("write", path)(source),
        WriteError::Encode(reason) => Error::Encode { path: path.to_owned(), reason },
    }
}

/// A file that vanishes unless it is given a name, with the permissions of any new file.
fn new_file(folder: &Path) -> io::Result<NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".zeroset-");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The system takes away what the user's umask forbids.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::{Seek, SeekFrom};

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn creates_folders_and_replaces() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a/b/file");
        for text in ["first, and longer", "second"] {
            write_file(&path, |out| Ok(out.write_all(text.as_bytes())?)).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names(path.parent().unwrap()), ["file"]);
    }

    #[test]
    fn may_seek() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        write_file(&path, |out| {
            out.write_all(b"abc")?;
            out.seek(SeekFrom::Start(1))?;
            Ok(out.write_all(b"x")?)
        })
        .unwrap();
        assert_eq!(fs::read(&path).unwrap(), b"axc");
    }

    /// Fails once `room` bytes are written, as a full disk does.
    struct Full<W> {
        out: W,
        room: usize,
    }

    impl<W: Write> Write for Full<W> {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let n = bytes.len().min(self.room);
            if n == 0 {
                return Err(io::ErrorKind::StorageFull.into());
            }
            self.room -= n;
            self.out.write(&bytes[..n])
        }

        fn flush(&mut self) -> io::Result<()> {
            self.out.flush()
        }
    }

    #[test]
    fn a_failure_on_the_way_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        fs::write(&path, "old").unwrap();
        for room in [0, 1, 100, BUFFER_BYTES, 3 * BUFFER_BYTES + 1] {
            let error = write_file(&path, |out| {
                Ok(Full { out, room }.write_all(&vec![7; 4 * BUFFER_BYTES])?)
            })
            .unwrap_err();
            assert!(matches!(&error, Error::Io { action: "write", path: p, source }
                if *p == path && source.kind() == io::ErrorKind::StorageFull));
        }
        let refused = write_file(&path, |_| Err(WriteError::Encode("too wide".into())));
        assert!(matches!(refused, Err(Error::Encode { .. })));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["file"]);
    }

    #[test]
    fn a_panic_on_the_way_leaves_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let run = || write_file(&path, |_| panic!("in the encoder"));
        assert!(std::panic::catch_unwind(run).is_err());
        assert_eq!(names(folder.path()), [""; 0]);
    }

    #[test]
    fn places_that_cannot_be_written_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        let below_a_file = write_file(&file.join("x/y"), |_| Ok(()));
        assert!(matches!(below_a_file, Err(Error::Io { action: "create", path, .. })
            if path == file.join("x")));
        let directory = folder.path().join("directory");
        fs::create_dir(&directory).unwrap();
        let onto_a_directory = write_file(&directory, |_| Ok(()));
        assert!(matches!(onto_a_directory, Err(Error::Io { action: "write", path, .. })
            if path == directory));
        assert_eq!(names(folder.path()), ["directory", "file"]);
    }

    #[cfg(unix)]
    #[test]
    fn permissions_are_those_of_any_new_file() {
        use std::os::unix::fs::PermissionsExt;
        let mode = |path: &Path| fs::metadata(path).unwrap().permissions().mode();
        let folder = tempfile::tempdir().unwrap();
        let (usual, ours) = (folder.path().join("usual"), folder.path().join("ours"));
        fs::write(&usual, "").unwrap();
        write_file(&ours, |_| Ok(())).unwrap();
        assert_eq!(mode(&ours), mode(&usual));

        let locked = folder.path().join("locked");
        fs::create_dir(&locked).unwrap();
        fs::set_permissions(&locked, fs::Permissions::from_mode(0o555)).unwrap();
        // The superuser may write anywhere; for anyone else this must be a clear error.
        let refused = File::create(locked.join("probe")).is_err();
        let outcome = write_file(&locked.join("file"), |_| Ok(()));
        assert_eq!(outcome.is_err(), refused);
    }
}
