//! 3MF, for printers: a ZIP archive with a model in XML, which says what its lengths are.
//!
//! Each mesh is an object with a colour and a place in the build. A mesh with a border is an object of
//! the type `surface`: what is printed must be closed.
//!
//! *Based on:* 3MF Consortium, "3D Manufacturing Format Core Specification" 1.3, and "Open Packaging
//! Conventions", ECMA-376 part 2.

use std::{
    fmt,
    io::{Seek, Write},
};

use zip::{CompressionMethod, DateTime, System, ZipWriter, result::ZipError, write::FileOptions};

use super::{
    MeshFormat, MeshOptions, Unit,
    check::{Placing, limit, placing},
};
use crate::{
    mesh::Mesh,
    output::{SOFTWARE, WriteError, atomic::BUFFER_BYTES, png::srgb_code},
};

/// Vertices of a mesh, by the schema.
const MAX_VERTICES: u64 = (1 << 31) - 1;

/// Files in an archive that are larger need headers that old readers do not know.
const MAX_SMALL: u64 = u32::MAX as u64;

/// More bytes than any vertex or triangle takes: three numbers of at most 50 digits, and words.
const BYTES_OF_LINE: u64 = 200;

/// What the parts of the archive are.
const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types">
<Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/>
<Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/>
</Types>
"#;

/// Which of them is the model.
const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships">
<Relationship Id="model" Target="/3D/3dmodel.model" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/>
</Relationships>
"#;

/// Writes all meshes.
///
/// # Errors
/// If `out` fails, or a mesh is empty or broken or has more than 2³¹ − 1 vertices.
pub fn write(
    meshes: &[Mesh],
    options: &MeshOptions,
    out: impl Write + Seek,
) -> Result<(), WriteError> {
    let placing = placing(meshes, options, MeshFormat::ThreeMf)?;
    for mesh in meshes {
        limit("vertices in one mesh", mesh.positions.len() as u64, MAX_VERTICES)?;
    }
    let n_lines =
        meshes.iter().map(|mesh| mesh.positions.len() + mesh.triangles.len()).sum::<usize>();
    let mut archive = ZipWriter::new(out);
    for (name, text) in [("[Content_Types].xml", CONTENT_TYPES), ("_rels/.rels", RELATIONSHIPS)] {
        archive.start_file(name, entry(false))?;
        archive.write_all(text.as_bytes())?;
    }
    archive.start_file("3D/3dmodel.model", entry(n_lines as u64 * BYTES_OF_LINE > MAX_SMALL))?;
    // The encoder is slow with small pieces.
    let mut model = std::io::BufWriter::with_capacity(BUFFER_BYTES, &mut archive);
    write_model(meshes, options, placing, &mut model)?;
    model.flush()?;
    drop(model);
    archive.finish()?.flush()?;
    Ok(())
}

/// A file in the archive: the same bytes on any day and any system.
fn entry(is_large: bool) -> FileOptions<'static, 'static, ()> {
    FileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(DateTime::DEFAULT)
        .system(System::Unix)
        .unix_permissions(0o644)
        .large_file(is_large)
}

fn write_model(
    meshes: &[Mesh],
    options: &MeshOptions,
    placing: Placing,
    out: &mut impl Write,
) -> Result<(), WriteError> {
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    let unit = unit_name(options.unit.unwrap_or(Unit::Millimeter));
    let namespace = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
    writeln!(out, r#"<model unit="{unit}" xml:lang="en-US" xmlns="{namespace}">"#)?;
    writeln!(out, r#"<metadata name="Title">{}</metadata>"#, Escaped(&options.scene))?;
    writeln!(out, r#"<metadata name="Application">{SOFTWARE}</metadata>"#)?;
    writeln!(out, r#"<resources><basematerials id="1">"#)?;
    for mesh in meshes {
        let [r, g, b] = mesh.color.map(srgb_code);
        let name = Escaped(&mesh.name);
        writeln!(out, r##"<base name="{name}" displaycolor="#{r:02X}{g:02X}{b:02X}"/>"##)?;
    }
    writeln!(out, "</basematerials>")?;
    // The materials are resource 1.
    for (i, mesh) in meshes.iter().enumerate() {
        let kind = if mesh.is_open() { "surface" } else { "model" };
        let (id, name) = (i + 2, Escaped(&mesh.name));
        writeln!(out, r#"<object id="{id}" type="{kind}" name="{name}" pid="1" pindex="{i}">"#)?;
        writeln!(out, "<mesh><vertices>")?;
        for &p in &mesh.positions {
            let [x, y, z] = placing.position(p);
            writeln!(out, r#"<vertex x="{x}" y="{y}" z="{z}"/>"#)?;
        }
        writeln!(out, "</vertices><triangles>")?;
        for [a, b, c] in &mesh.triangles {
            writeln!(out, r#"<triangle v1="{a}" v2="{b}" v3="{c}"/>"#)?;
        }
        writeln!(out, "</triangles></mesh></object>")?;
    }
    writeln!(out, "</resources><build>")?;
    for i in 0..meshes.len() {
        writeln!(out, r#"<item objectid="{}"/>"#, i + 2)?;
    }
    writeln!(out, "</build></model>")?;
    Ok(())
}

fn unit_name(unit: Unit) -> &'static str {
    match unit {
        Unit::Micron => "micron",
        Unit::Millimeter => "millimeter",
        Unit::Centimeter => "centimeter",
        Unit::Inch => "inch",
        Unit::Foot => "foot",
        Unit::Meter => "meter",
    }
}

/// A text between tags or in quotes; what XML cannot hold becomes `_`.
struct Escaped<'a>(&'a str);

impl fmt::Display for Escaped<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        use fmt::Write as _;
        self.0.chars().try_for_each(|c| match c {
            '&' => f.write_str("&amp;"),
            '<' => f.write_str("&lt;"),
            '>' => f.write_str("&gt;"),
            '"' => f.write_str("&quot;"),
            '\0'..' ' | '\u{fffe}' | '\u{ffff}' => f.write_char('_'),
            _ => f.write_char(c),
        })
    }
}

impl From<ZipError> for WriteError {
    fn from(error: ZipError) -> Self {
        match error {
            ZipError::Io(error) => Self::Io(error),
            other => Self::Encode(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{
        super::{Up, sample::*},
        *,
    };
    use std::io::{Cursor, Read};

    fn archive(options: &MeshOptions) -> zip::ZipArchive<Cursor<Vec<u8>>> {
        let mut file = Cursor::new(Vec::new());
        write(&meshes(), options, &mut file).unwrap();
        zip::ZipArchive::new(file).unwrap()
    }

    /// The values of an attribute, in order.
    fn values<'a>(xml: &'a str, element: &str, name: &str) -> Vec<&'a str> {
        let start = format!("<{element} ");
        let after = |tag: &'a str| tag.split_once(&format!(" {name}=\"")).unwrap().1;
        xml.split(&start[..start.len() - 1])
            .skip(1)
            .filter(|tag| tag.starts_with(' '))
            .map(|tag| after(tag).split('"').next().unwrap())
            .collect()
    }

    #[test]
    fn the_model_is_what_it_was() {
        for (up, place) in [(None, (|p| p) as fn([f32; 3]) -> [f32; 3]), (Some(Up::Y), y_up)] {
            let options =
                MeshOptions { up, unit: Some(Unit::Inch), scene: "a < b".into(), ..<_>::default() };
            let mut archive = archive(&options);
            assert_eq!(archive.len(), 3);
            let mut xml = String::new();
            let mut model = archive.by_name("3D/3dmodel.model").unwrap();
            assert_eq!(model.compression(), CompressionMethod::Deflated);
            assert_eq!(model.last_modified(), Some(DateTime::DEFAULT));
            model.read_to_string(&mut xml).unwrap();
            assert_eq!(values(&xml, "model", "unit"), ["inch"]);
            assert!(xml.contains(">a &lt; b<"));
            assert_eq!(values(&xml, "object", "type"), ["model", "surface"]);
            let name = "Würfel &lt;1&gt; &amp; &quot;a&quot;";
            assert_eq!(values(&xml, "object", "name"), [name, "two words"]);
            assert_eq!(values(&xml, "base", "displaycolor"), ["#FF7F00", "#597C95"]);
            assert_eq!(values(&xml, "item", "objectid"), values(&xml, "object", "id"));
            let column = |element, name| values(&xml, element, name);
            let positions: Vec<_> =
                meshes().iter().flat_map(|m| m.positions.clone()).map(place).collect();
            let triangles: Vec<_> = meshes().iter().flat_map(|m| m.triangles.clone()).collect();
            let read: Vec<Vec<f32>> = ["x", "y", "z"]
                .map(|name| column("vertex", name).iter().map(|x| x.parse().unwrap()).collect())
                .into();
            let read: Vec<[f32; 3]> =
                (0..read[0].len()).map(|i| [0, 1, 2].map(|axis: usize| read[axis][i])).collect();
            assert_eq!(read, positions);
            let read: Vec<Vec<u32>> = ["v1", "v2", "v3"]
                .map(|name| column("triangle", name).iter().map(|v| v.parse().unwrap()).collect())
                .into();
            let read: Vec<[u32; 3]> =
                (0..read[0].len()).map(|i| [0, 1, 2].map(|k: usize| read[k][i])).collect();
            assert_eq!(read, triangles);
        }
    }

    #[test]
    fn what_xml_cannot_hold_is_replaced() {
        assert_eq!(Escaped("a\u{1}\n&é😀").to_string(), "a__&amp;é😀");
    }

    #[test]
    fn lines_are_as_short_as_promised() {
        let widest = [-f32::MIN_POSITIVE, -f32::MAX, -1.234_567_9e-38].map(|x| x.to_string().len());
        let words = r#"<triangle v1="" v2="" v3=""/>"#.len() as u64 + 1;
        assert!(3 * (*widest.iter().max().unwrap() as u64) + words <= BYTES_OF_LINE);
    }
}
