# One-line conveniences; none is needed to build, test or run.

# Everything that must hold before a change lands
ci:
    .ci/run

# Render a scene: just render configs/heart.toml
render *ARGUMENTS:
    cargo run --release -- {{ARGUMENTS}}

# All tests
test:
    cargo test --release

# Open every kind of file with other programs, `--full` with Blender and MeshLab; missing ones are installed
consumers *ARGUMENTS:
    ZEROSET_INSTALL=1 tests/consumers.sh {{ARGUMENTS}}

# Make the gallery's page in out/gallery, and open it in Chromium
gallery:
    cargo run --release -- gallery --page out/gallery
    ZEROSET_INSTALL=1 tests/gallery.sh out/gallery

# Renew the reference pictures of a scene, or `all`; then look at them and run the tests
bless NAME:
    -ZEROSET_BLESS={{NAME}} cargo test --release --test golden

# Renew the words of a mistake, or `all`
bless-words NAME:
    -ZEROSET_BLESS={{NAME}} cargo test --release --test diagnostics

# Time every stage of the paper's scenes
bench:
    cargo bench

# Time Fidget at the same work, `pictures` or `meshes`; the tables are for BENCHMARKS.md, and ZEROSET_DATA adds models
bench-peers *NAMES:
    RUSTFLAGS="-C target-cpu=native" cargo run --release --locked --manifest-path benches/peers/Cargo.toml -- {{NAMES}}

# What octrees of samples take beside grids: the tables of BENCHMARKS, and ZEROSET_DATA adds scans
storage:
    cargo run --release --example storage

# Time VTK at the same isosurfaces; Python must have `vtk` and `numpy`, and ZEROSET_DATA adds scans
bench-volumes:
    python3 benches/volumes.py

# Scene 1 by Zeroset and by POV-Ray, which must be installed: the picture and the figures of README
beside-povray:
    cargo run --release --example povray
