//! What is reported, and its form as Markdown.

use super::Plot;
use serde::Serialize;
use serde_json::Value;
use std::fmt::Write;

/// A table of text; the first column names the row.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Table {
    /// One line above it; may be empty.
    pub title: String,
    /// Heads of the columns.
    pub columns: Vec<String>,
    /// As many cells as columns in each.
    pub rows: Vec<Vec<String>>,
}

/// A plot with its caption.
#[derive(Debug, Clone, Serialize)]
pub struct Figure {
    /// File name without ending.
    pub name: String,
    /// What is seen.
    pub caption: String,
    /// The plot.
    pub plot: Plot,
}

/// A part of a report.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Section {
    /// Its heading.
    pub title: String,
    /// Paragraphs before the tables.
    pub text: Vec<String>,
    /// Tables.
    pub tables: Vec<Table>,
    /// Plots.
    pub figures: Vec<Figure>,
    /// The numbers as they were computed.
    pub data: Value,
    /// Parts of this part.
    pub sections: Vec<Section>,
}

impl Table {
    /// No rows yet.
    pub fn new(title: &str, columns: &[&str]) -> Self {
        let columns = columns.iter().map(|&c| c.to_owned()).collect();
        Self { title: title.into(), columns, rows: Vec::new() }
    }

    /// Adds a row.
    ///
    /// # Panics
    /// If it has more or fewer cells than there are columns.
    pub fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        let cells: Vec<String> = cells.into_iter().collect();
        assert_eq!(cells.len(), self.columns.len(), "cells of a row of {:?}", self.title);
        self.rows.push(cells);
    }
}

impl Section {
    /// All plots, those of inner sections behind its own.
    pub fn all_figures(&self) -> Vec<&Figure> {
        let inner = self.sections.iter().flat_map(Self::all_figures);
        self.figures.iter().chain(inner).collect()
    }
}

/// The report as Markdown. `figures`: the folder that the plots are in as `NAME.svg`, relative to
/// the file; without one they are left out.
pub fn markdown(report: &Section, figures: Option<&str>) -> String {
    let mut text = String::new();
    write_section(&mut text, report, 1, figures);
    text
}

fn write_section(text: &mut String, section: &Section, level: usize, figures: Option<&str>) {
    // Writing to a string cannot fail.
    let _ = writeln!(text, "{} {}\n", "#".repeat(level), section.title);
    for paragraph in &section.text {
        let _ = writeln!(text, "{paragraph}\n");
    }
    for table in &section.tables {
        if !table.title.is_empty() {
            let _ = writeln!(text, "{}\n", table.title);
        }
        let line = |cells: &[String]| {
            let cells: Vec<_> = cells.iter().map(|c| c.replace('|', "\\|")).collect();
            format!("| {} |", cells.join(" | "))
        };
        let _ = writeln!(text, "{}", line(&table.columns));
        let _ = writeln!(text, "|---|{}", "---:|".repeat(table.columns.len().saturating_sub(1)));
        for row in &table.rows {
            let _ = writeln!(text, "{}", line(row));
        }
        text.push('\n');
    }
    if let Some(folder) = figures {
        for figure in &section.figures {
            let _ = writeln!(text, "![{}]({folder}/{}.svg)\n", figure.caption, figure.name);
        }
    }
    for inner in &section.sections {
        write_section(text, inner, level + 1, figures);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_has_tables_and_nested_headings() {
        let mut table = Table::new("Times", &["method", "s"]);
        table.row(["a|b".into(), "1".into()]);
        let inner = Section { title: "Inner".into(), tables: vec![table], ..Default::default() };
        let report = Section {
            title: "Outer".into(),
            text: vec!["Words.".into()],
            sections: vec![inner],
            ..Default::default()
        };
        let expected = "# Outer\n\nWords.\n\n## Inner\n\nTimes\n\n| method | s |\n|---|---:|\n\
                        | a\\|b | 1 |\n\n";
        assert_eq!(markdown(&report, None), expected);
    }
}
