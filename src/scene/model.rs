//! Polygon models: files that lie beside the scene, and where their polygons go.

use glam::{DAffine3, DMat3, DVec3};

use super::{
    color::{WHITE, default_color},
    lower::Lower,
    spec::{ModelSpec, Section, UpSpec},
};
use crate::{diagnostic::Diagnostic, polygons::Polygons, raster::Model};

impl Lower<'_> {
    /// All models that could be made, after `n_surfaces` surfaces.
    pub(super) fn models(&mut self, specs: &[Section<ModelSpec>], n_surfaces: usize) -> Vec<Model> {
        let model = |(i, section)| self.model(n_surfaces + i, section);
        specs.iter().enumerate().filter_map(model).collect()
    }

    fn model(&mut self, index: usize, section: &Section<ModelSpec>) -> Option<Model> {
        let spec = &section.spec;
        let placing = self.placing(spec);
        let Some(file) = &spec.file else {
            if !section.is_damaged {
                self.errors.push(
                    Diagnostic::new(section.span.clone(), "the model has no file")
                        .label("no `file`")
                        .help("name an OBJ, glTF or GLB file, as in file = \"teapot.obj\""),
                );
            }
            return None;
        };
        let path = self.beside(file).map_err(|mistake| self.errors.push(mistake)).ok()?;
        let name = spec.name.clone().unwrap_or_else(|| file.get_ref().clone());
        let polygons = Polygons::read(&path);
        let refused = |why: String| {
            let message = format!("cannot use {}: {why}", file.get_ref());
            self.errors.push(
                Diagnostic::new(file.span(), message)
                    .help("the name is relative to the folder of the scene"),
            );
        };
        let polygons = polygons.map_err(refused).ok()?;
        let is_white = self.has_matcap || !polygons.colors.is_empty();
        let usual = if is_white { WHITE } else { default_color(index) };
        let color = spec.color.unwrap_or(usual);
        let material = self.material_of(
            (color, spec.back_color),
            spec.specular.as_ref(),
            spec.shininess.as_ref(),
        );
        Some(Model { name, polygons: polygons.placed(placing), material })
    }

    /// From the file's coordinates to the scene's.
    fn placing(&mut self, spec: &ModelSpec) -> DAffine3 {
        let upright = match spec.up.unwrap_or_default() {
            UpSpec::Z => DMat3::IDENTITY,
            // x stays, y becomes z, z becomes −y.
            UpSpec::Y => DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y),
        };
        let scale = spec.scale.as_ref().map_or(1.0, |scale| self.positive("scale", scale));
        let degrees = spec.rotate.as_ref().map_or([0.0; 3], |r| self.coordinates("rotate", r));
        let [x, y, z] = degrees.map(f64::to_radians);
        let turn =
            DMat3::from_rotation_z(z) * DMat3::from_rotation_y(y) * DMat3::from_rotation_x(x);
        let translate =
            spec.translate.as_ref().map_or([0.0; 3], |t| self.coordinates("translate", t));
        DAffine3::from_mat3_translation(turn * (scale * upright), translate.into())
    }
}
