//! Surfer's `.jsurf` files: an algebraic surface in a ball, with its camera, lights and colours.
//!
//! Such a file holds properties. A point p of the camera's space (right, up, towards the viewer) is at
//! T C⁻¹ p in the space of the ball of radius 1 around the origin, and at S T C⁻¹ p in that of the
//! formula, where S is `surface_transform_matrix` times 10^`scale_factor`, T `transform_matrix` times
//! `rotation_matrix` and C `camera_transform`. The scene is in the space of the formula.
//!
//! *Based on:* what IMAGINARY's jsurf 0.3 makes of its files.

use std::{collections::BTreeMap, fmt::Write as _};

use glam::{DMat4, DVec3};

use super::{
    Converted, Source, comments, header, number,
    properties::{self, Property},
    quoted,
    similarity::Similarity,
    snapped, vector,
};
use crate::{
    diagnostic::{Diagnostic, did_you_mean},
    expr,
};

/// Surfer has so many lights.
const N_LIGHTS: usize = 8;

/// What lights of Surfer add up with what materials send back; here that is the same for all.
const DIFFUSE: f64 = 0.8;

/// Keys without those of parameters, materials and lights.
const KEYS: [&str; 10] = [
    "surface_equation",
    "background_color",
    "camera_type",
    "camera_fov_y",
    "camera_height",
    "camera_transform",
    "transform_matrix",
    "rotation_matrix",
    "surface_transform_matrix",
    "scale_factor",
];

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
    let mut file = File { properties: &properties, mistakes: Vec::new(), notes: Vec::new() };
    file.note_unknown_keys();
    let sections =
        [file.surface(), file.space(), file.image()].into_iter().flatten().collect::<Vec<_>>();
    let File { mistakes, notes, .. } = file;
    if !mistakes.is_empty() {
        return Err(mistakes);
    }
    let mut scene = header(source, "a file of IMAGINARY's Surfer");
    comments(&mut scene, &notes);
    scene.push_str("version = 1\n");
    for section in sections {
        scene.push('\n');
        scene.push_str(&section);
    }
    Ok(Converted { scene, notes })
}

/// The file, and what is found out about it.
struct File<'a> {
    properties: &'a [Property],
    mistakes: Vec<Diagnostic>,
    notes: Vec<String>,
}

impl<'a> File<'a> {
    fn find(&self, key: &str) -> Option<&'a Property> {
        self.properties.iter().find(|property| property.key == key)
    }

    fn complain(&mut self, at: &Property, message: String, help: impl Into<String>) {
        self.mistakes.push(Diagnostic::new(at.span.clone(), message).help(help));
    }

    /// The N numbers of a key, if it is there and they are.
    fn numbers<const N: usize>(&mut self, key: &str) -> Option<[f64; N]> {
        let property = self.find(key)?;
        let words = property.value.split_whitespace().map(|word| {
            let number = word.trim_end_matches(['f', 'F']).parse().ok();
            number.filter(|number: &f64| number.is_finite())
        });
        let numbers: Option<Vec<f64>> = words.collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        if numbers.is_none() {
            let wanted =
                if N == 1 { "a number" } else { &format!("{N} numbers with blanks between them") };
            let found = match property.value.as_str() {
                "" => "nothing".to_owned(),
                value => format!("`{}`", super::line(value)),
            };
            let message = format!("`{key}` is {found}, not {wanted}");
            let help = format!("write {key}={}", vec!["1.0"; N].join(" "));
            self.complain(property, message, help);
        }
        numbers
    }

    fn number(&mut self, key: &str) -> Option<f64> {
        self.numbers::<1>(key).map(|[number]| number)
    }

    /// One of two words: whether it is the first one.
    fn word(&mut self, key: &str, words: [&str; 2]) -> Option<bool> {
        let property = self.find(key)?;
        let place = words.iter().position(|&word| word == property.value.trim());
        if place.is_none() {
            let message = format!("`{key}` is `{}`", super::line(&property.value));
            self.complain(property, message, format!("it may be {} or {}", words[0], words[1]));
        }
        place.map(|place| place == 0)
    }

    /// A colour as `"#rrggbb"`.
    fn color(&mut self, key: &str) -> Option<String> {
        let color = self.numbers::<3>(key)?;
        if let (Some(property), false) =
            (self.find(key), color.iter().all(|part| (0.0..=1.0).contains(part)))
        {
            let message = format!("`{key}` is no colour");
            self.complain(property, message, "red, green and blue are numbers from 0 to 1");
        }
        let [r, g, b] = color.map(|part| (part.clamp(0.0, 1.0) * 255.0).round());
        // Clamped above.
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
        let [r, g, b] = [r as u8, g as u8, b as u8];
        Some(format!("\"#{r:02x}{g:02x}{b:02x}\""))
    }

    fn matrix(&mut self, key: &str) -> Option<DMat4> {
        self.numbers::<16>(key).map(|rows| DMat4::from_cols_array(&rows).transpose())
    }

    fn note_unknown_keys(&mut self) {
        let materials = ["front_material_", "back_material_"];
        let materials =
            materials.iter().flat_map(|side| MATERIAL_KEYS.map(|key| format!("{side}{key}")));
        let lights = (0..N_LIGHTS).flat_map(|i| LIGHT_KEYS.map(|key| format!("light_{key}_{i}")));
        let known: Vec<String> =
            KEYS.map(str::to_owned).into_iter().chain(materials).chain(lights).collect();
        for property in self.properties {
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
            if let Some(color) = self.color(&format!("{side}_material_color")) {
                let _ = writeln!(text, "{key} = {color}");
            }
        }
        let specular = ["intensity", "iIntensity"]
            .map(|end| self.number(&format!("front_material_specular_{end}")));
        if let Some(specular) = specular[0].or(specular[1]) {
            let _ = writeln!(text, "specular = {}", number(specular.clamp(0.0, 1.0)));
        }
        if let Some(shininess) = self.number("front_material_shininess") {
            let _ = writeln!(text, "shininess = {}", shininess.round().clamp(1.0, 1000.0));
        }
        Some(text)
    }

    /// Writes `[params]`; gives each parameter's name here.
    fn parameters(&mut self, text: &mut String) -> BTreeMap<&'a str, String> {
        let mut names = BTreeMap::new();
        for property in self.properties {
            let Some(name) = property.key.strip_prefix(PARAMETER) else { continue };
            let Some(value) = self.number(&property.key) else { continue };
            // A scene may use `r` and others as well, but would be warned of it.
            let here = if expr::has_meaning(name) { format!("{name}_") } else { name.to_owned() };
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

    /// The formula in our language; `names` are those of the parameters here.
    fn formula(&mut self, names: &BTreeMap<&str, String>) -> Option<String> {
        let Some(property) = self.find("surface_equation") else {
            self.mistakes.push(
                Diagnostic::new(0..0, "the file has no `surface_equation`")
                    .help("a Surfer file has a line such as surface_equation=x^2+y^2+z^2-1"),
            );
            return None;
        };
        let ast = match expr::parse(&property.value) {
            Ok(ast) => ast,
            Err(mistakes) => {
                self.mistakes.extend(mistakes.into_iter().map(|mistake| {
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
                    None if ["x", "y", "z"].contains(&name.as_str()) => {}
                    None => self.mistakes.push(
                        Diagnostic::new(
                            property.place(span),
                            format!("the parameter `{name}` has no value"),
                        )
                        .help(format!("add a line such as {PARAMETER}{name}=0.5")),
                    ),
                },
                // The natural one.
                expr::Node::Call(name, _) if name == "log" => {
                    formula.replace_range(span.clone(), "ln");
                }
                _ => {}
            }
        }
        Some(formula)
    }

    /// `[domain]`, `[camera]` and `[[light]]`, which the matrices tell.
    fn space(&mut self) -> Option<String> {
        let identity = DMat4::IDENTITY;
        let scale = match self.number("scale_factor") {
            Some(exponent) if exponent.abs() > 9.0 => {
                let property = self.find("scale_factor")?;
                let message = format!("`scale_factor` is {exponent}");
                let help = "it is a power of ten from -9 to 9";
                self.complain(property, message, help);
                return None;
            }
            exponent => libm::pow(10.0, exponent.unwrap_or(0.0)),
        };
        let formula_from_ball = self.matrix("surface_transform_matrix").unwrap_or(identity)
            * DMat4::from_scale(DVec3::splat(scale));
        let turned = self.matrix("transform_matrix").unwrap_or(identity)
            * self.matrix("rotation_matrix").unwrap_or(identity);
        // One step back, as Surfer's own files have it.
        let camera = self.matrix("camera_transform");
        let camera = camera.unwrap_or(DMat4::from_translation(DVec3::NEG_Z));
        if !self.mistakes.is_empty() {
            return None;
        }
        let formula_from_camera = formula_from_ball * turned * camera.inverse();
        let [ball, view] = [formula_from_ball, formula_from_camera].map(Similarity::new);
        let (Some(ball), Some(view)) = (ball, view) else {
            let matrices = [
                "rotation_matrix",
                "transform_matrix",
                "surface_transform_matrix",
                "camera_transform",
            ];
            let property = matrices.iter().find_map(|key| self.find(key))?;
            let message = "the matrices stretch or mirror space".to_owned();
            self.complain(
                property,
                message,
                "rows of each must be those of a turn, times one factor, and a shift",
            );
            return None;
        };
        let mut text = ball.domain();
        self.camera(&mut text, &ball, &view);
        let middle = view.linear.inverse() * (ball.shift - view.shift);
        self.lights(&mut text, middle, ball.scale / view.scale);
        Some(text)
    }

    fn camera(&mut self, text: &mut String, ball: &Similarity, view: &Similarity) {
        let is_flat =
            self.word("camera_type", ["ORTHOGRAPHIC_CAMERA", "PERSPECTIVE_CAMERA"]).unwrap_or(true);
        let [height, fov] = ["camera_height", "camera_fov_y"].map(|key| self.number(key));
        let (height, fov) = (height.unwrap_or(2.0), fov.unwrap_or(60.0));
        let (key, value, range) = if is_flat {
            ("camera_height", height, 1e-6..=1e6)
        } else {
            ("camera_fov_y", fov, 0.1..=179.0)
        };
        if let (Some(property), false) = (self.find(key), range.contains(&value)) {
            let (least, most) = (range.start(), range.end());
            self.complain(
                property,
                format!("`{key}` is {value}"),
                format!("it may be from {least} to {most}"),
            );
        }
        let forward = -view.axis(2);
        let ahead = forward.dot(ball.shift - view.shift);
        let target = view.shift + forward * if ahead > 0.0 { ahead } else { view.scale };
        if is_flat && ahead < 0.999 * ball.scale {
            let hides = "Surfer hides what is behind it; here that shows";
            self.notes.push(format!("the camera stands in the ball of the surface, and {hides}"));
        }
        text.push_str("\n[camera]\n");
        let _ = match is_flat {
            true => {
                writeln!(
                    text,
                    "projection = \"orthographic\"\nheight = {}",
                    number(height * view.scale)
                )
            }
            false => writeln!(text, "fov = {}", number(fov)),
        };
        for (key, place) in [("eye", view.shift), ("target", target)] {
            let _ = writeln!(text, "{key} = {}", vector(snapped(place, ball.scale)));
        }
        let _ = writeln!(text, "up = {}", vector(snapped(view.axis(1), 1.0)));
    }

    /// The lights, of which the file says where they are in the camera's space; so are the ball's
    /// `middle` and `radius`. Light from far away comes from the same side everywhere.
    fn lights(&mut self, text: &mut String, middle: DVec3, radius: f64) {
        let diffuse = self.number("front_material_diffuse_intensity").unwrap_or(DIFFUSE);
        for i in 0..N_LIGHTS {
            let is_on = self.word(&format!("light_status_{i}"), ["ON", "OFF"]).unwrap_or(false);
            let position = self.numbers::<3>(&format!("light_position_{i}"));
            let color = self.color(&format!("light_color_{i}"));
            let intensity = self.number(&format!("light_intensity_{i}")).unwrap_or(1.0);
            if !is_on {
                continue;
            }
            let direction = DVec3::from(position.unwrap_or_default()) - middle;
            let distance = direction.length();
            if distance < FAR * radius {
                let message = "is near the surface; here it is far away, on the same side";
                self.notes.push(format!("light {i} {message}"));
            }
            let direction = if distance > 0.0 { direction / distance } else { DVec3::Z };
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
        let color = self.color("background_color")?;
        Some(format!("[image]\nbackground = {color}\n"))
    }
}

const WHITE: &str = "\"#ffffff\"";

/// From so many radii away, light comes nearly from the same side everywhere.
const FAR: f64 = 20.0;
