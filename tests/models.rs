//! Function graphs that other programs wrote: shared data, in the folder that `ZEROSET_DATA` names.

#![expect(clippy::unwrap_used, reason = "a test that cannot prepare its case has failed")]

use std::{
    env, fs,
    io::{self, Write as _},
    path::{Path, PathBuf},
};

use zeroset::{
    eval::Machine,
    expr::Expr,
    math::Point,
    pipeline::{self, Options, Picture},
    progress::Unwatched,
    scene,
};

/// The folder of the models, if there is one; it is not part of this repository.
fn models(test: &str) -> Option<PathBuf> {
    let folder = env::var_os("ZEROSET_DATA").map(|data| Path::new(&data).join("models"));
    if folder.is_none() {
        // The test harness keeps what `println` says to itself.
        let _ = writeln!(io::stderr(), "SKIPPED {test}: ZEROSET_DATA is not set");
    }
    folder
}

/// The model as the only surface of a scene, with further keys and sections.
fn render(folder: &Path, model: &str, rest: &str) -> Picture {
    let text = format!(
        "version = 1\n[image]\nwidth = 120\nheight = 120\n[[surface]]\nfile = '{model}'\n{rest}"
    );
    let scene = scene::parse_with(Path::new("model.toml"), &text, &[], Some(folder))
        .unwrap_or_else(|rejection| panic!("{model}: {:?}", rejection.diagnostics));
    let options = Options { resolution: Some(96), find_all: true, ..Options::default() };
    pipeline::render(&scene, &options, &Unwatched).unwrap()
}

/// The least and the most indices of voxels, axis by axis.
fn bounds(picture: &Picture) -> [[u32; 3]; 2] {
    let storage = &picture.storages[0];
    let mut bounds = [[u32::MAX; 3], [0; 3]];
    for part in storage.parts() {
        storage.visit(part, &mut |voxel| {
            for axis in 0..3 {
                bounds[0][axis] = bounds[0][axis].min(voxel.ijk[axis]);
                bounds[1][axis] = bounds[1][axis].max(voxel.ijk[axis]);
            }
        });
    }
    bounds
}

#[test]
fn the_bear_is_found() {
    let Some(folder) = models("the bear") else { return };
    let picture = render(&folder, "bear.vm", "[domain]\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n");
    let n_voxels = picture.statistics.voxels.stored;
    assert!((20_000..80_000).contains(&n_voxels), "{n_voxels}");
    let [least, most] = bounds(&picture);
    assert!((0..3).all(|axis| most[axis] - least[axis] > 48), "{least:?} {most:?}");
}

/// The text depends on x and y alone; a capped clip makes letters of it.
#[test]
fn the_text_is_extruded() {
    let Some(folder) = models("the text") else { return };
    let picture = render(
        &folder,
        "prospero.vm",
        "clip = 'abs(z) <= 0.1'\ncap = true\n[domain]\nmin = [-1, -1, -1]\nmax = [1, 1, 1]\n\
         [camera]\ndirection = [0, 0, 1]\nup = [0, 1, 0]\n",
    );
    let [least, most] = bounds(&picture);
    assert_eq!((least[2], most[2]), (43, 52), "0.1 lies in the fifth layer from the middle");
    let covered = picture.frame.digest().n_covered as f64 / (120.0 * 120.0);
    assert!((0.1..0.5).contains(&covered), "letters cover {covered} of the picture");
}

#[test]
fn the_tanglecube_has_its_values() {
    let Some(folder) = models("the tanglecube") else { return };
    let text = fs::read_to_string(folder.join("tanglecube.vm")).unwrap();
    let tape = Expr::from_vm(&text).unwrap().tape();
    let mut machine = Machine::<Point<f64>, 1>::default();
    let steps = || (-12..=12).map(|i| 0.25 * f64::from(i));
    for [x, y, z] in
        steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])))
    {
        machine.run((), &tape, &[x, y, z].map(|v| [Point(v)]), false);
        let value = machine.slot(tape.result())[0].0;
        let part = |v: f64| v * v * (v * v - 5.0);
        // Multiples of 1/256, which f64 adds without rounding.
        assert_eq!(value, part(x) + part(y) + part(z) + 10.0, "at ({x}, {y}, {z})");
    }
    let picture = render(&folder, "tanglecube.vm", "");
    let [least, most] = bounds(&picture);
    assert!((0..3).all(|axis| least[axis] + most[axis] == 95), "{least:?} {most:?}");
}
