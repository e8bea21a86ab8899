//! The elements: how large and of which colour their atoms are drawn.
//!
//! *Based on:* A. Bondi, "van der Waals Volumes and Radii" (1964), with what M. Mantina and others,
//! "Consistent van der Waals Radii for the Whole Main Group" (2009), and S. Alvarez, "A cartography of the
//! van der Waals territories" (2013), have of further elements; promethium, of which nothing is known,
//! lies between its neighbours. Radii of bonds: B. Cordero and others, "Covalent radii revisited" (2008).
//! Colours: those of Jmol.

/// An element.
#[derive(Debug, PartialEq)]
pub(super) struct Element {
    /// One or two letters, the first of them large.
    pub(super) symbol: &'static str,
    /// In small letters.
    pub(super) name: &'static str,
    /// The van der Waals radius, in Ångström.
    pub(super) radius: f64,
    /// The covalent radius, in Ångström.
    pub(super) bond_radius: f64,
    /// `0xrrggbb`
    pub(super) color: u32,
}

impl Element {
    /// The element of this symbol, in small letters or large ones; deuterium and tritium are hydrogen.
    pub(super) fn of_symbol(symbol: &str) -> Option<&'static Self> {
        let symbol = if matches!(symbol, "D" | "d" | "T" | "t") { "H" } else { symbol };
        ELEMENTS.iter().find(|element| element.symbol.eq_ignore_ascii_case(symbol))
    }

    /// The element with this number of protons.
    pub(super) fn of_number(number: u32) -> Option<&'static Self> {
        ELEMENTS.get(usize::try_from(number).ok()?.checked_sub(1)?)
    }
}

const fn element(
    symbol: &'static str,
    name: &'static str,
    radius: f64,
    bond_radius: f64,
    color: u32,
) -> Element {
    Element { symbol, name, radius, bond_radius, color }
}

/// From hydrogen on, in the order of the periodic table.
static ELEMENTS: [Element; 96] = [
    element("H", "hydrogen", 1.20, 0.31, 0xffffff),
    element("He", "helium", 1.40, 0.28, 0xd9ffff),
    element("Li", "lithium", 1.81, 1.28, 0xcc80ff),
    element("Be", "beryllium", 1.53, 0.96, 0xc2ff00),
    element("B", "boron", 1.92, 0.84, 0xffb5b5),
    element("C", "carbon", 1.70, 0.73, 0x909090),
    element("N", "nitrogen", 1.55, 0.71, 0x3050f8),
    element("O", "oxygen", 1.52, 0.66, 0xff0d0d),
    element("F", "fluorine", 1.47, 0.57, 0x90e050),
    element("Ne", "neon", 1.54, 0.58, 0xb3e3f5),
    element("Na", "sodium", 2.27, 1.66, 0xab5cf2),
    element("Mg", "magnesium", 1.73, 1.41, 0x8aff00),
    element("Al", "aluminium", 1.84, 1.21, 0xbfa6a6),
    element("Si", "silicon", 2.10, 1.11, 0xf0c8a0),
    element("P", "phosphorus", 1.80, 1.07, 0xff8000),
    element("S", "sulfur", 1.80, 1.05, 0xffff30),
    element("Cl", "chlorine", 1.75, 1.02, 0x1ff01f),
    element("Ar", "argon", 1.88, 1.06, 0x80d1e3),
    element("K", "potassium", 2.75, 2.03, 0x8f40d4),
    element("Ca", "calcium", 2.31, 1.76, 0x3dff00),
    element("Sc", "scandium", 2.58, 1.70, 0xe6e6e6),
    element("Ti", "titanium", 2.46, 1.60, 0xbfc2c7),
    element("V", "vanadium", 2.42, 1.53, 0xa6a6ab),
    element("Cr", "chromium", 2.45, 1.39, 0x8a99c7),
    element("Mn", "manganese", 2.45, 1.50, 0x9c7ac7),
    element("Fe", "iron", 2.44, 1.42, 0xe06633),
    element("Co", "cobalt", 2.40, 1.38, 0xf090a0),
    element("Ni", "nickel", 2.40, 1.24, 0x50d050),
    element("Cu", "copper", 2.38, 1.32, 0xc88033),
    element("Zn", "zinc", 2.39, 1.22, 0x7d80b0),
    element("Ga", "gallium", 1.87, 1.22, 0xc28f8f),
    element("Ge", "germanium", 2.11, 1.20, 0x668f8f),
    element("As", "arsenic", 1.85, 1.19, 0xbd80e3),
    element("Se", "selenium", 1.90, 1.20, 0xffa100),
    element("Br", "bromine", 1.83, 1.20, 0xa62929),
    element("Kr", "krypton", 2.02, 1.16, 0x5cb8d1),
    element("Rb", "rubidium", 3.03, 2.20, 0x702eb0),
    element("Sr", "strontium", 2.49, 1.95, 0x00ff00),
    element("Y", "yttrium", 2.75, 1.90, 0x94ffff),
    element("Zr", "zirconium", 2.52, 1.75, 0x94e0e0),
    element("Nb", "niobium", 2.56, 1.64, 0x73c2c9),
    element("Mo", "molybdenum", 2.45, 1.54, 0x54b5b5),
    element("Tc", "technetium", 2.44, 1.47, 0x3b9e9e),
    element("Ru", "ruthenium", 2.46, 1.46, 0x248f8f),
    element("Rh", "rhodium", 2.44, 1.42, 0x0a7d8c),
    element("Pd", "palladium", 2.15, 1.39, 0x006985),
    element("Ag", "silver", 2.53, 1.45, 0xc0c0c0),
    element("Cd", "cadmium", 2.49, 1.44, 0xffd98f),
    element("In", "indium", 1.93, 1.42, 0xa67573),
    element("Sn", "tin", 2.17, 1.39, 0x668080),
    element("Sb", "antimony", 2.06, 1.39, 0x9e63b5),
    element("Te", "tellurium", 2.06, 1.38, 0xd47a00),
    element("I", "iodine", 1.98, 1.39, 0x940094),
    element("Xe", "xenon", 2.16, 1.40, 0x429eb0),
    element("Cs", "caesium", 3.43, 2.44, 0x57178f),
    element("Ba", "barium", 2.68, 2.15, 0x00c900),
    element("La", "lanthanum", 2.98, 2.07, 0x70d4ff),
    element("Ce", "cerium", 2.88, 2.04, 0xffffc7),
    element("Pr", "praseodymium", 2.92, 2.03, 0xd9ffc7),
    element("Nd", "neodymium", 2.95, 2.01, 0xc7ffc7),
    element("Pm", "promethium", 2.93, 1.99, 0xa3ffc7),
    element("Sm", "samarium", 2.90, 1.98, 0x8fffc7),
    element("Eu", "europium", 2.87, 1.98, 0x61ffc7),
    element("Gd", "gadolinium", 2.83, 1.96, 0x45ffc7),
    element("Tb", "terbium", 2.79, 1.94, 0x30ffc7),
    element("Dy", "dysprosium", 2.87, 1.92, 0x1fffc7),
    element("Ho", "holmium", 2.81, 1.92, 0x00ff9c),
    element("Er", "erbium", 2.83, 1.89, 0x00e675),
    element("Tm", "thulium", 2.79, 1.90, 0x00d452),
    element("Yb", "ytterbium", 2.80, 1.87, 0x00bf38),
    element("Lu", "lutetium", 2.74, 1.87, 0x00ab24),
    element("Hf", "hafnium", 2.63, 1.75, 0x4dc2ff),
    element("Ta", "tantalum", 2.53, 1.70, 0x4da6ff),
    element("W", "tungsten", 2.57, 1.62, 0x2194d6),
    element("Re", "rhenium", 2.49, 1.51, 0x267dab),
    element("Os", "osmium", 2.48, 1.44, 0x266696),
    element("Ir", "iridium", 2.41, 1.41, 0x175487),
    element("Pt", "platinum", 2.29, 1.36, 0xd0d0e0),
    element("Au", "gold", 2.32, 1.36, 0xffd123),
    element("Hg", "mercury", 2.45, 1.32, 0xb8b8d0),
    element("Tl", "thallium", 1.96, 1.45, 0xa6544d),
    element("Pb", "lead", 2.02, 1.46, 0x575961),
    element("Bi", "bismuth", 2.07, 1.48, 0x9e4fb5),
    element("Po", "polonium", 1.97, 1.40, 0xab5c00),
    element("At", "astatine", 2.02, 1.50, 0x754f45),
    element("Rn", "radon", 2.20, 1.50, 0x428296),
    element("Fr", "francium", 3.48, 2.60, 0x420066),
    element("Ra", "radium", 2.83, 2.21, 0x007d00),
    element("Ac", "actinium", 2.80, 2.15, 0x70abfa),
    element("Th", "thorium", 2.93, 2.06, 0x00baff),
    element("Pa", "protactinium", 2.88, 2.00, 0x00a1ff),
    element("U", "uranium", 2.71, 1.96, 0x008fff),
    element("Np", "neptunium", 2.82, 1.90, 0x0080ff),
    element("Pu", "plutonium", 2.81, 1.87, 0x006bff),
    element("Am", "americium", 2.83, 1.80, 0x545cf2),
    element("Cm", "curium", 3.05, 1.69, 0x785ce3),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn elements_are_found() {
        let symbol = |number| Element::of_number(number).map(|element| element.symbol);
        let found = [0, 1, 26, 79, 96, 97].map(symbol);
        assert_eq!(found, [None, Some("H"), Some("Fe"), Some("Au"), Some("Cm"), None]);
        assert_eq!(Element::of_symbol("cL"), Element::of_number(17));
        assert_eq!(Element::of_symbol("D"), Element::of_number(1));
        assert_eq!(Element::of_symbol("Xx"), None);
    }

    /// No radius is out of place by a factor, and no symbol stands twice.
    #[test]
    fn the_table_is_sane() {
        for (i, element) in ELEMENTS.iter().enumerate() {
            let Element { symbol, radius, bond_radius, color, .. } = *element;
            assert!((1.2..=3.5).contains(&radius), "{symbol}");
            assert!((0.28..=2.6).contains(&bond_radius) && bond_radius < radius, "{symbol}");
            assert!(color <= 0xffffff, "{symbol}");
            let twice = ELEMENTS[..i].iter().any(|other| other.symbol == symbol);
            assert!(!twice && symbol.len() <= 2, "{symbol}");
        }
    }
}
