//! Surfer's `.jsurf` files: an algebraic surface in a ball, with its camera, lights and colours.
//!
//! Such a file holds properties. A point p of the camera's space (right, up, towards the viewer) is at
//! T C⁻¹ p in the space of the ball of radius 1 around the origin, and at S T C⁻¹ p in that of the
//! formula. C is `camera_transform`. T is `rotation_matrix`, or else `transform_matrix`, and S is
//! 10^`scale_factor`, or else `surface_transform_matrix`: Surfer writes both and reads the first. The
//! scene is in the space of the formula.
//!
//! *Based on:* what IMAGINARY's Surfer and jsurf 0.3 make of such files.

use std::{collections::BTreeMap, fmt::Write as _};

use glam::{DMat4, DVec3};

use super::{
    Converted, Source, camera::Lens, comments, header, number, properties, quoted,
    similarity::Similarity, snapped, values::Values, vector,
};
use crate::{
    diagnostic::{Diagnostic, did_you_mean},
    expr,
};

/// Surfer has so many lights.
const N_LIGHTS: usize = 8;

/// The keys of matrices.
const MATRICES: [&str; 4] =
    ["rotation_matrix", "transform_matrix", "surface_transform_matrix", "camera_transform"];

/// The smallest radius of the ball; the largest is its inverse.
const MIN_SCALE: f64 = 1e-10;

/// The farthest that the ball is from the origin, and the camera from the ball, in radii.
const MAX_SHIFT: f64 = 1e3;

/// What lights of Surfer add up with what materials send back; here that is the same for all.
const DIFFUSE: f64 = 0.8;

/// Keys without those of matrices, parameters, materials and lights.
const KEYS: [&str; 8] = [
    "surface_equation",
    "background_color",
    "camera_type",
    "camera_fov_y",
    "camera_height",
    "scale_factor",
    // Surfer writes these, and nobody reads them.
    "transform",
    "surface_transform",
];

/// What formulas may call.
const FUNCTIONS: [&str; 13] = [
    "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "ceil", "floor", "abs",
    "sign",
];

/// Names that are coordinates, whatever parameters there are.
const AXES: [&str; 3] = ["x", "y", "z"];

const PARAMETER: &str = "surface_parameter_";

/// Keys of materials after `front_material_` and `back_material_`; early versions wrote the last one.
const MATERIAL_KEYS: [&str; 6] = [
    "color",
    "ambient_intensity",
    "diffuse_intensity",
    "shininess",
    "specular_intensity",
    "specular_iIntensity",
];

/// Keys of lights between `light_` and their number.
const LIGHT_KEYS: [&str; 4] = ["position", "color", "intensity", "status"];

/// The scene of such a file.
pub(super) fn import(source: &Source<'_>) -> Result<Converted, Vec<Diagnostic>> {
    let properties = properties::read(source.text).map_err(|mistake| vec![mistake])?;
    let mut file = File { values: Values::new(&properties), notes: Vec::new() };
    file.note_unknown_keys();
    let sections = [file.surface(), file.space(), file.image()];
    let File { values, notes } = file;
    if !values.mistakes.is_empty() {
        return Err(values.mistakes);
    }
    let mut scene = header(source, "a file of IMAGINARY's Surfer");
    comments(&mut scene, &notes);
    scene.push_str("version = 1\n");
    for section in sections.iter().flatten() {
        scene.push('\n');
        scene.push_str(section);
    }
    Ok(Converted { scene, notes })
}

/// The file, and what is found out about it.
struct File<'a> {
    values: Values<'a>,
    notes: Vec<String>,
}

impl<'a> File<'a> {
    fn note_unknown_keys(&mut self) {
        let materials = ["front_material_", "back_material_"];
        let materials =
            materials.iter().flat_map(|side| MATERIAL_KEYS.map(|key| format!("{side}{key}")));
        let lights = (0..N_LIGHTS).flat_map(|i| LIGHT_KEYS.map(|key| format!("light_{key}_{i}")));
        let known: Vec<String> = KEYS
            .iter()
            .chain(&MATRICES)
            .map(|&key| key.to_owned())
            .chain(materials)
            .chain(lights)
            .collect();
        for property in self.values.properties {
            let key = &property.key;
            if key.starts_with(PARAMETER) || known.contains(key) {
                continue;
            }
            let meant = did_you_mean(key, known.iter().map(String::as_str));
            let meant = meant.map(|meant| format!("; did you mean `{meant}`?"));
            let key = super::line(key);
            self.notes.push(format!("`{key}` is unknown and ignored{}", meant.unwrap_or_default()));
        }
    }

    /// `[params]` and `[[surface]]`.
    fn surface(&mut self) -> Option<String> {
        let mut text = String::new();
        let names = self.parameters(&mut text);
        let formula = self.formula(&names)?;
        let _ = writeln!(text, "[[surface]]\nf = {}", quoted(&formula));
        // Surfer's front is where its gradient points to the viewer, which is outside.
        for (key, side) in [("color", "front"), ("back_color", "back")] {
            if let Some(color) = self.values.color(&format!("{side}_material_color")) {
                let _ = writeln!(text, "{key} = {color}");
            }
        }
        let specular = ["intensity", "iIntensity"]
            .map(|end| self.values.number(&format!("front_material_specular_{end}")));
        if let Some(specular) = specular[0].or(specular[1]) {
            let _ = writeln!(text, "specular = {}", number(specular.clamp(0.0, 1.0)));
        }
        if let Some(shininess) = self.values.number("front_material_shininess") {
            let _ = writeln!(text, "shininess = {}", shininess.round().clamp(1.0, 1000.0));
        }
        Some(text)
    }

    /// Writes `[params]`; gives each parameter's name here.
    fn parameters(&mut self, text: &mut String) -> BTreeMap<&'a str, String> {
        let mut names = BTreeMap::new();
        for property in self.values.properties {
            let Some(name) = property.key.strip_prefix(PARAMETER) else { continue };
            if !expr::is_name(name) || AXES.contains(&name) {
                let key = super::line(&property.key);
                self.notes.push(format!("`{key}` is ignored: no formula can name it"));
                continue;
            }
            let Some(value) = self.values.number(&property.key) else { continue };
            // A scene may use `r` and others as well, but would be warned of it.
            let mut here = name.to_owned();
            while expr::has_meaning(&here) || (here != name && self.is_parameter(&here)) {
                here.push('_');
            }
            if names.is_empty() {
                text.push_str("[params]\n");
            }
            let _ = writeln!(text, "{} = {value}", super::key(&here));
            names.insert(name, here);
        }
        if !names.is_empty() {
            text.push('\n');
        }
        names
    }

    fn is_parameter(&self, name: &str) -> bool {
        self.values.find(&format!("{PARAMETER}{name}")).is_some()
    }

    /// The formula in our language; `names` are those of the parameters here.
    fn formula(&mut self, names: &BTreeMap<&str, String>) -> Option<String> {
        let Some(property) = self.values.find("surface_equation") else {
            self.values.mistakes.push(
                Diagnostic::new(0..0, "the file has no `surface_equation`")
                    .help("a Surfer file has a line such as surface_equation=x^2+y^2+z^2-1"),
            );
            return None;
        };
        let ast = match expr::parse(&property.value) {
            Ok(ast) => ast,
            Err(mistakes) => {
                self.values.mistakes.extend(mistakes.into_iter().map(|mistake| {
                    let span = property.place(&mistake.span);
                    Diagnostic { span, ..mistake }
                }));
                return None;
            }
        };
        // From the end, so that places before it stay where they are.
        let mut formula = property.value.clone();
        let mut nodes: Vec<_> = ast.nodes.iter().collect();
        nodes.sort_by_key(|(_, span)| span.start);
        for (node, span) in nodes.into_iter().rev() {
            match node {
                expr::Node::Name(name) => match names.get(name.as_str()) {
                    Some(here) => formula.replace_range(span.clone(), here),
                    None if AXES.contains(&name.as_str()) => {}
                    None => self.values.mistakes.push(
                        Diagnostic::new(
                            property.place(span),
                            format!("the parameter `{name}` has no value"),
                        )
                        .help(format!("add a line such as {PARAMETER}{name}=0.5")),
                    ),
                },
                expr::Node::Call(name, arguments) => {
                    if !FUNCTIONS.contains(&name.as_str()) || arguments.len() != 1 {
                        let known = FUNCTIONS.join(", ");
                        let message =
                            format!("`{name}` is no function of Surfer with such arguments");
                        let mistake = Diagnostic::new(property.place(span), message);
                        let help = format!("its functions, of one argument each, are {known}");
                        self.values.mistakes.push(mistake.help(help));
                    } else if name == "log" {
                        // The natural one.
                        formula.replace_range(span.clone(), "ln");
                    }
                }
                _ => {}
            }
        }
        Some(formula)
    }

    /// `[domain]`, `[camera]` and `[[light]]`, which the matrices tell.
    fn space(&mut self) -> Option<String> {
        let formula_from_ball = match self.values.find("scale_factor") {
            Some(_) => {
                let exponent = self.values.number_in("scale_factor", -9.0..=9.0, 0.0);
                let scale = DMat4::from_scale(DVec3::splat(libm::pow(10.0, exponent)));
                self.one_of("surface_transform_matrix", "scale_factor", scale)
            }
            None => self.values.matrix("surface_transform_matrix").unwrap_or_default(),
        };
        let turned = match self.values.matrix("rotation_matrix") {
            Some(turn) => self.one_of("transform_matrix", "rotation_matrix", turn),
            None => self.values.matrix("transform_matrix").unwrap_or_default(),
        };
        let lens = self.lens();
        let camera = self.values.matrix("camera_transform");
        let camera = camera.unwrap_or(DMat4::from_translation(DVec3::NEG_Z * lens.distance()));
        let formula_from_camera = formula_from_ball * turned * camera.inverse();
        let [ball, view] = [formula_from_ball, formula_from_camera].map(Similarity::new);
        let (Some(ball), Some(view)) = (ball, view) else {
            let help = "rows of each must be those of a turn, times one factor, and a shift";
            self.complain_of_matrices("stretch or mirror space", help);
            return None;
        };
        let is_near = ball.shift.abs().max_element() <= MAX_SHIFT * ball.scale
            && view.shift.distance(ball.shift) <= MAX_SHIFT * ball.scale;
        if !(is_near && (MIN_SCALE..=1.0 / MIN_SCALE).contains(&ball.scale)) {
            let help = "the ball and the camera must be at most a thousand radii of the ball away";
            self.complain_of_matrices("lead too far away, or to a ball too small or large", help);
            return None;
        }
        let mut text = ball.domain();
        text.push_str(&lens.camera(&ball, &view));
        if matches!(lens, Lens::Flat { .. }) && view.ahead(ball.shift) < 0.999 * ball.scale {
            let hides = "Surfer hides what is behind it; here that shows";
            self.notes.push(format!("the camera stands in the ball of the surface, and {hides}"));
        }
        let middle = view.linear.inverse() * (ball.shift - view.shift);
        self.lights(&mut text, middle, ball.scale / view.scale);
        Some(text)
    }

    /// What the matrices do cannot be: the first of them is marked, which it is more likely than not.
    fn complain_of_matrices(&mut self, what: &str, help: &str) {
        let span = MATRICES.iter().find_map(|key| self.values.find(key)).map(|p| p.span.clone());
        let mistake = Diagnostic::new(span.unwrap_or(0..0), format!("the matrices {what}"));
        self.values.mistakes.push(mistake.help(help));
    }

    /// `chosen`, which counts although there is another matrix.
    fn one_of(&mut self, ignored: &str, instead: &str, chosen: DMat4) -> DMat4 {
        if let Some(other) = self.values.matrix(ignored)
            && !other.abs_diff_eq(chosen, SAME)
            && !other.abs_diff_eq(DMat4::IDENTITY, SAME)
        {
            self.notes.push(format!("`{ignored}` is ignored, as in Surfer, for `{instead}`"));
        }
        chosen
    }

    fn lens(&mut self) -> Lens {
        let types = ["ORTHOGRAPHIC_CAMERA", "PERSPECTIVE_CAMERA"];
        match self.values.word("camera_type", types).unwrap_or(true) {
            true => Lens::Flat { height: self.values.number_in("camera_height", 1e-6..=1e6, 2.0) },
            false => Lens::Wide { fov: self.values.number_in("camera_fov_y", 0.1..=179.0, 60.0) },
        }
    }

    /// The lights, of which the file says where they are in the camera's space; so are the ball's
    /// `middle` and `radius`. Light from far away comes from the same side everywhere.
    fn lights(&mut self, text: &mut String, middle: DVec3, radius: f64) {
        let diffuse = self.values.number("front_material_diffuse_intensity").unwrap_or(DIFFUSE);
        for i in 0..N_LIGHTS {
            let is_on =
                self.values.word(&format!("light_status_{i}"), ["ON", "OFF"]).unwrap_or(false);
            let position = self.values.numbers::<3>(&format!("light_position_{i}"));
            let color = self.values.color(&format!("light_color_{i}"));
            let intensity = self.values.number(&format!("light_intensity_{i}")).unwrap_or(1.0);
            if !is_on {
                continue;
            }
            let direction = DVec3::from(position.unwrap_or_default()) - middle;
            let distance = direction.length();
            if distance < FAR * radius {
                let message = "is near the surface; here it is far away, on the same side";
                self.notes.push(format!("light {i} {message}"));
            }
            let direction = direction.normalize_or(DVec3::Z);
            let _ = write!(
                text,
                "\n[[light]]\ndirection = {}\nrelative_to = \"camera\"\n",
                vector(snapped(direction, 1.0))
            );
            if let Some(color) = color.filter(|color| color != WHITE) {
                let _ = writeln!(text, "color = {color}");
            }
            let intensity = (intensity * diffuse / DIFFUSE).clamp(0.0, 1000.0);
            let _ = writeln!(text, "intensity = {}", number(intensity));
        }
    }

    /// `[image]`.
    fn image(&mut self) -> Option<String> {
        let color = self.values.color("background_color")?;
        Some(format!("[image]\nbackground = {color}\n"))
    }
}

const WHITE: &str = "\"#ffffff\"";

/// From so many radii away, light comes nearly from the same side everywhere.
const FAR: f64 = 20.0;

/// By how much parts of matrices that are meant to be the same differ at most.
const SAME: f64 = 1e-3;
