//! Tables, for people (Markdown) and for programs (CSV).

use std::fmt::Write as _;

/// What stands in a field.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Cell {
    /// Words.
    Text(String),
    /// A count.
    Count(u64),
    /// A number, with so many decimals where people read it.
    Number(f64, usize),
}

/// Rows under columns.
#[derive(Clone, Debug, Default)]
pub(super) struct Table {
    /// Names of columns.
    pub(super) columns: Vec<String>,
    /// As many fields in each as there are columns.
    pub(super) rows: Vec<Vec<Cell>>,
}

impl Table {
    /// Without rows yet.
    #[must_use]
    pub(super) fn new(columns: &[&str]) -> Self {
        Self { columns: columns.iter().map(|&name| name.to_owned()).collect(), rows: Vec::new() }
    }

    /// Numbers are to the right, counts have thousands apart.
    #[must_use]
    pub(super) fn markdown(&self) -> String {
        let is_number =
            |i: usize| self.rows.iter().all(|row| !matches!(row.get(i), Some(Cell::Text(_))));
        let mut text = format!("| {} |\n|", self.columns.join(" | "));
        for i in 0..self.columns.len() {
            text += if is_number(i) { "--:|" } else { "---|" };
        }
        text.push('\n');
        for row in &self.rows {
            let fields: Vec<String> = row.iter().map(Cell::words).collect();
            let _ = writeln!(text, "| {} |", fields.join(" | "));
        }
        text
    }

    /// One row a line, numbers in full.
    #[must_use]
    pub(super) fn csv(&self) -> String {
        let line = |fields: Vec<String>| fields.join(",") + "\n";
        let mut text = line(self.columns.iter().map(|name| quoted(name)).collect());
        for row in &self.rows {
            text += &line(row.iter().map(Cell::exact).collect());
        }
        text
    }
}

impl Cell {
    /// Words.
    pub(super) fn text(text: impl Into<String>) -> Self {
        Self::Text(text.into())
    }

    /// As people read it.
    pub(super) fn words(&self) -> String {
        match self {
            Self::Text(text) => text.clone(),
            Self::Count(n) => thousands(*n),
            Self::Number(x, _) if !x.is_finite() => "–".to_owned(),
            Self::Number(x, decimals) => format!("{x:.decimals$}"),
        }
    }

    fn exact(&self) -> String {
        match self {
            Self::Text(text) => quoted(text),
            Self::Count(n) => n.to_string(),
            Self::Number(x, _) if x.is_finite() => x.to_string(),
            Self::Number(..) => String::new(),
        }
    }
}

/// With thousands apart.
#[must_use]
pub(super) fn thousands(n: u64) -> String {
    let digits = n.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn quoted(text: &str) -> String {
    match text.contains([',', '"', '\n']) {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_kinds() {
        let mut table = Table::new(&["name", "n", "part"]);
        table.rows.push(vec![Cell::text("a, b"), Cell::Count(1_234_567), Cell::Number(0.5, 2)]);
        table.rows.push(vec![Cell::text("c"), Cell::Count(0), Cell::Number(f64::NAN, 2)]);
        assert_eq!(
            table.markdown(),
            "| name | n | part |\n|---|--:|--:|\n| a, b | 1,234,567 | 0.50 |\n| c | 0 | – |\n"
        );
        assert_eq!(table.csv(), "name,n,part\n\"a, b\",1234567,0.5\nc,0,\n");
    }
}
