//! The surfaces, each written once for Zeroset and once for Fidget.

use std::{
    env, fs,
    path::{Path, PathBuf},
};

use fidget::context::{Context, Node, Tree};
use zeroset::{
    expr::{self, Expr},
    math::{Aabb, Lattice},
    scene,
};

/// A surface for both programs.
pub struct Workload {
    /// For the tables.
    pub name: &'static str,
    /// F for Zeroset.
    pub expr: Expr,
    /// F for Fidget is a node of this.
    pub context: Context,
    /// That node.
    pub root: Node,
    /// Where it is looked for.
    pub domain: Aabb,
}

/// Voxels along an axis.
pub const RESOLUTION: u32 = 512;

impl Workload {
    /// The domain cut into voxels.
    pub fn lattice(&self, resolution: u32) -> Lattice {
        Lattice::new(self.domain, resolution)
    }

    /// Of the domain, a cube about the origin.
    pub fn half_edge(&self) -> f64 {
        self.domain.max.z
    }

    /// A scene file of the project.
    fn scene(name: &'static str, file: &str, tree: &Tree) -> Self {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let mut scene = scene::load(&root.join("configs").join(file)).unwrap();
        let mut context = Context::new();
        let root = context.import(tree);
        let expr = scene.surfaces.remove(0).expr;
        Self { name, expr, context, root, domain: scene.domain.unwrap() }
    }

    /// An equation in a cube about the origin.
    fn equation(name: &'static str, text: &str, half_edge: f64, tree: &Tree) -> Self {
        let mut context = Context::new();
        let root = context.import(tree);
        Self { name, expr: equation(text), context, root, domain: cube(half_edge) }
    }

    /// A function graph from a file, in the cube of 2 units about the origin.
    fn model(name: &'static str, path: &Path) -> Self {
        let text = fs::read_to_string(path).unwrap();
        let (context, root) = Context::from_text(text.as_bytes()).unwrap();
        Self { name, expr: Expr::from_vm(&text).unwrap(), context, root, domain: cube(1.0) }
    }

    /// The part of a prism along z that lies in |z| <= `half_height`.
    fn cut(mut self, half_height: f32) -> Self {
        let z = self.context.z();
        let height = self.context.abs(z).unwrap();
        let slab = self.context.sub(height, half_height).unwrap();
        self.root = self.context.max(self.root, slab).unwrap();
        self.expr = self.expr.intersected(&equation(&format!("abs(z) - {half_height}")));
        self
    }
}

fn equation(text: &str) -> Expr {
    Expr::resolve(&expr::parse(text).unwrap(), &[]).unwrap().expr
}

fn cube(half_edge: f64) -> Aabb {
    Aabb { min: [-half_edge; 3].into(), max: [half_edge; 3].into() }
}

/// What all voxels are found of.
pub fn enumerated() -> Vec<Workload> {
    let mut all = scenes();
    all.extend([
        gyroid(),
        sphere(),
        Workload::equation("torus", "(sqrt(x^2 + y^2) - 1)^2 + z^2 = 0.16", 1.5, &torus()),
        Workload::equation(
            "tanglecube",
            "x^4 - 5*x^2 + y^4 - 5*y^2 + z^4 - 5*z^2 + 11.8 = 0",
            3.0,
            &tanglecube(),
        ),
    ]);
    all.extend(model("bear.vm"));
    all.extend(model("prospero.vm").map(|prism| prism.cut(0.1)));
    all
}

/// What pictures are made of: closed towards the viewer, because Fidget closes what leaves the domain.
pub fn pictured() -> Vec<Workload> {
    let mut all = scenes();
    all.extend([gyroid().cut(15.0)]);
    all.extend(model("bear.vm"));
    all
}

/// What is meshed. The gyroid ends at the border of the domain, where both leave it open.
pub fn meshed() -> Vec<Workload> {
    let mut all = scenes();
    all.extend([gyroid(), sphere()]);
    all.extend(model("bear.vm"));
    all
}

/// The paper's scenes.
fn scenes() -> Vec<Workload> {
    vec![
        Workload::scene("Scene 1", "scene1.toml", &blend()),
        Workload::scene("Scene 2", "scene2.toml", &lobes(4.0, 8.0)),
        Workload::scene("Scene 3", "scene3.toml", &lobes(3.0, 4.0)),
    ]
}

/// A model, where `ZEROSET_DATA` says where models are.
fn model(file: &'static str) -> Option<Workload> {
    let Some(data) = env::var_os("ZEROSET_DATA") else {
        eprintln!("ZEROSET_DATA is not set: {file} is left out");
        return None;
    };
    Some(Workload::model(file, &PathBuf::from(data).join("models").join(file)))
}

/// configs/scene1.toml
fn blend() -> Tree {
    const SPHERES: [[f32; 4]; 10] = [
        [0.00, 0.00, 0.00, 1.60],
        [0.42, 0.05, 0.12, 2.20],
        [-0.40, 0.10, -0.10, 2.10],
        [0.06, 0.44, -0.08, 2.30],
        [-0.05, -0.43, 0.10, 2.20],
        [0.08, -0.06, 0.46, 2.40],
        [-0.10, 0.04, -0.45, 2.30],
        [0.66, 0.26, 0.24, 2.90],
        [-0.58, -0.22, -0.34, 2.70],
        [0.20, 0.62, 0.28, 2.80],
    ];
    let (x, y, z) = Tree::axes();
    let support = |[a, b, c, s]: [f32; 4]| {
        let squares =
            (x.clone() - a).square() + (y.clone() - b).square() + (z.clone() - c).square();
        (1.0 - squares * (s * s)).max(0.0).square().square()
    };
    0.25 - SPHERES.map(support).into_iter().reduce(|sum, term| sum + term).unwrap()
}

/// `r = sin(a theta) * sin(b phi)`. The angle phi comes from an arctangent: Fidget's arccosine of an
/// interval is NaN near the axis.
fn lobes(a: f32, b: f32) -> Tree {
    let (x, y, z) = Tree::axes();
    let rho_squared = x.square() + y.square();
    let r = (rho_squared.clone() + z.square()).sqrt();
    let (theta, phi) = (y.atan2(x), rho_squared.sqrt().atan2(z));
    r - (theta * a).sin() * (phi * b).sin()
}

fn gyroid() -> Workload {
    let (x, y, z) = Tree::axes();
    Workload::equation(
        "gyroid, five periods",
        "sin(x)*cos(y) + sin(y)*cos(z) + sin(z)*cos(x) = 0",
        5.0 * std::f64::consts::PI,
        &(x.sin() * y.cos() + y.sin() * z.cos() + z.sin() * x.cos()),
    )
}

fn sphere() -> Workload {
    let (x, y, z) = Tree::axes();
    let tree = x.square() + y.square() + z.square() - 1.0;
    Workload::equation("sphere", "x^2 + y^2 + z^2 = 1", 1.2, &tree)
}

fn torus() -> Tree {
    let (x, y, z) = Tree::axes();
    ((x.square() + y.square()).sqrt() - 1.0).square() + z.square() - 0.16
}

fn tanglecube() -> Tree {
    let (x, y, z) = Tree::axes();
    let powers = |v: Tree| v.square().square() - 5.0 * v.square();
    powers(x) + powers(y) + powers(z) + 11.8
}
