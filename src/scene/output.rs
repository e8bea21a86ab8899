//! Which files are written: `[output]` and `[mesh]`.

use std::path::{Component, Path, PathBuf};

use super::{
    MeshSettings, Outputs,
    leaf::Target,
    lower::{Lower, is_auto},
    spanned::Spanned,
    spec::{AdvanceSpec, SceneSpec, Section, StrokeSpec, UnitSpec, UpSpec, VertexSpec},
};
use crate::{
    diagnostic::Diagnostic,
    mesh::{Border, VertexPlace},
    output::meshes::{MeshFormat, Unit, Up},
};

/// What is wanted only if the file says so.
type Wish<'a> = Option<&'a Spanned<Target>>;

impl Lower<'_> {
    pub(super) fn outputs(&mut self, name: &str, scene: &SceneSpec) -> Outputs {
        let spec = &scene.output.spec;
        let meshes = [
            (MeshFormat::Glb, &spec.glb),
            (MeshFormat::Gltf, &spec.gltf),
            (MeshFormat::Obj, &spec.obj),
            (MeshFormat::Ply, &spec.mesh_ply),
            (MeshFormat::Stl, &spec.stl),
            (MeshFormat::ThreeMf, &spec.three_mf),
        ];
        if is_auto(&scene.voxels.spec) {
            let all = meshes.iter().filter_map(|(_, wish)| wish.as_ref()).chain(&spec.ply);
            for file in all.filter(|file| *file.get_ref() != Target::Switch(false)) {
                self.errors.push(
                    Diagnostic::new(
                        file.span(),
                        "the file holds all voxels, and resolution = \"auto\" finds some",
                    )
                    .label("which voxels?")
                    .help("write a number for `resolution`, or remove this"),
                );
            }
        }
        if let Some(apng) = &spec.apng
            && *apng.get_ref() != Target::Switch(false)
            && scene.animation.is_none()
        {
            self.errors.push(
                Diagnostic::new(apng.span(), "`apng` is for films")
                    .label("the scene has no [animation]")
                    .help("remove it, or add [animation] with the number of `frames`"),
            );
        }
        if let Some(sheet) = &spec.sheet
            && *sheet.get_ref() != Target::Switch(false)
            && scene.sweep.is_none()
        {
            self.errors.push(
                Diagnostic::new(sheet.span(), "`sheet` is for sweeps")
                    .label("the scene has no [sweep]")
                    .help("remove it, or add [sweep] with parameters and their values"),
            );
        }
        let pushes = |stroke: &Section<StrokeSpec>| {
            let advance = stroke.spec.advance.as_ref().map(Spanned::get_ref);
            advance == Some(&AdvanceSpec::Contact)
        };
        if let Some(forces) = &spec.forces
            && *forces.get_ref() != Target::Switch(false)
            && !scene.sculptures.iter().flat_map(|sculpture| &sculpture.spec.strokes).any(pushes)
        {
            self.errors.push(
                Diagnostic::new(forces.span(), "`forces` are what pushed tools meet")
                    .label("no stroke pushes its tool")
                    .help("remove it, or add advance = \"contact\" to a [[sculpture.stroke]]"),
            );
        }
        let mut wished = |ending: &str, wish: Wish<'_>| {
            wish.and_then(|wish| self.file(&format!("{name}.{ending}"), Some(wish)))
        };
        let of_meshes = meshes.into_iter().filter_map(|(format, wish)| {
            // Points have the plain name.
            let ending = if format == MeshFormat::Ply { "mesh.ply" } else { format.ending() };
            Some((format, wished(ending, wish.as_ref())?))
        });
        let meshes = of_meshes.collect();
        let (ply, apng) = (wished("ply", spec.ply.as_ref()), wished("apng", spec.apng.as_ref()));
        let forces = wished("csv", spec.forces.as_ref());
        let sheet = match scene.sweep {
            Some(_) => self.file(&format!("{name}.sheet.png"), spec.sheet.as_ref()),
            None => None,
        };
        Outputs {
            png: self.file(&format!("{name}.png"), spec.png.as_ref()),
            exr: self.file(&format!("{name}.exr"), spec.exr.as_ref()),
            layers: spec.layers.unwrap_or(true),
            ply,
            apng,
            sheet,
            forces,
            meshes,
        }
    }

    /// How surfaces become meshes.
    pub(super) fn mesh(&mut self, scene: &SceneSpec) -> MeshSettings {
        let spec = &scene.mesh.spec;
        MeshSettings {
            border: if spec.cap.unwrap_or(false) { Border::Capped } else { Border::Open },
            vertex: match spec.vertex.unwrap_or_default() {
                VertexSpec::Polished => VertexPlace::Polished,
                VertexSpec::Linear => VertexPlace::Linear,
            },
            up: spec.up.map(|up| match up {
                UpSpec::Y => Up::Y,
                UpSpec::Z => Up::Z,
            }),
            scale: spec.scale.as_ref().map_or(1.0, |scale| self.positive("scale", scale)),
            unit: spec.unit.map(|unit| match unit {
                UnitSpec::Micron => Unit::Micron,
                UnitSpec::Millimeter => Unit::Millimeter,
                UnitSpec::Centimeter => Unit::Centimeter,
                UnitSpec::Inch => Unit::Inch,
                UnitSpec::Foot => Unit::Foot,
                UnitSpec::Meter => Unit::Meter,
            }),
            most_triangles: spec.triangles.as_ref().map(|n| {
                // A tetrahedron is the least that is closed.
                self.whole("triangles", Some(n), 4..=i64::from(u32::MAX), 4)
            }),
        }
    }

    /// The file to write: `default`, none, or the one named, which must end as `default` does.
    fn file(&mut self, default: &str, target: Option<&Spanned<Target>>) -> Option<PathBuf> {
        let Some(target) = target else { return Some(default.into()) };
        let name = match target.get_ref() {
            Target::Switch(write) => return write.then(|| default.into()),
            Target::File(name) => Path::new(name),
        };
        let ending = Path::new(default).extension().unwrap_or_default();
        let below = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
        if !name.components().all(below) {
            self.errors.push(
                Diagnostic::new(target.span(), "the file would lie outside the output directory")
                    .label("not a relative name, or one with `..`")
                    .help("choose the directory on the command line with --out"),
            );
        } else if name.extension() != Some(ending) {
            let ending = ending.display();
            self.errors.push(
                Diagnostic::new(target.span(), format!("the name must end in `.{ending}`"))
                    .help(format!("write a name such as \"picture.{ending}\", true or false")),
            );
        }
        Some(name.to_owned())
    }
}
