//! The report as one page: nothing is loaded, nothing runs.

use super::plot::escaped;
use super::{Section, Table};
use std::fmt::Write;

const STYLE: &str = "body{font:15px/1.5 sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem;color:#222}\
    table{border-collapse:collapse;margin:.5rem 0 1.2rem}caption{text-align:left;padding:.2rem 0}\
    th,td{border:1px solid #ccc;padding:.2rem .5rem;text-align:right}\
    th:first-child,td:first-child{text-align:left}th{background:#f3f3f3}\
    figure{margin:1rem 0;display:inline-block}figcaption{color:#555;max-width:40rem}svg{max-width:100%}";

/// HTML with the plots in it.
pub fn page(report: &Section) -> String {
    let mut html = format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title>\
         <style>{STYLE}</style></head><body>\n",
        escaped(&report.title)
    );
    write_section(&mut html, report, 1);
    html.push_str("</body></html>\n");
    html
}

fn write_section(html: &mut String, section: &Section, level: usize) {
    // Writing to a string cannot fail.
    let level_shown = level.min(6);
    let _ = writeln!(html, "<h{level_shown}>{}</h{level_shown}>", escaped(&section.title));
    for paragraph in &section.text {
        let _ = writeln!(html, "<p>{}</p>", with_code(&escaped(paragraph)));
    }
    section.tables.iter().for_each(|table| write_table(html, table));
    for figure in &section.figures {
        let caption = escaped(&figure.caption);
        let _ = writeln!(
            html,
            "<figure>{}<figcaption>{caption}</figcaption></figure>",
            figure.plot.svg()
        );
    }
    section.sections.iter().for_each(|inner| write_section(html, inner, level + 1));
}

fn write_table(html: &mut String, table: &Table) {
    let cells = |tag: &str, cells: &[String]| {
        cells.iter().fold(String::new(), |mut line, cell| {
            let _ = write!(line, "<{tag}>{}</{tag}>", with_code(&escaped(cell)));
            line
        })
    };
    let caption = with_code(&escaped(&table.title));
    let _ = writeln!(
        html,
        "<table><caption>{caption}</caption><tr>{}</tr>",
        cells("th", &table.columns)
    );
    for row in &table.rows {
        let _ = writeln!(html, "<tr>{}</tr>", cells("td", row));
    }
    html.push_str("</table>\n");
}

/// Text between backquotes as code; a quote without an end stays.
fn with_code(text: &str) -> String {
    let parts: Vec<_> = text.split('`').collect();
    if parts.len() % 2 == 0 {
        return text.into();
    }
    let tag = |(i, part): (usize, &&str)| match i % 2 {
        0 => (*part).to_owned(),
        _ => format!("<code>{part}</code>"),
    };
    parts.iter().enumerate().map(tag).collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Figure, Plot};
    use super::*;

    #[test]
    fn the_page_holds_all_and_loads_nothing() {
        let mut table = Table::new("Times & errors", &["method", "s"]);
        table.row(["<b>".into(), "1".into()]);
        let figure = Figure { name: "f".into(), caption: "seen".into(), plot: Plot::default() };
        let inner = Section {
            title: "Inner".into(),
            text: vec!["`--spp 4`, odd ` quote".into()],
            tables: vec![table],
            figures: vec![figure],
            ..Default::default()
        };
        let html =
            page(&Section { title: "All".into(), sections: vec![inner], ..Default::default() });
        for expected in
            ["<h1>All</h1>", "<h2>Inner</h2>", "&lt;b&gt;", "Times &amp; errors", "<svg", "seen"]
        {
            assert!(html.contains(expected), "{expected}: {html}");
        }
        // The name space of SVG is an address, of which nothing is loaded.
        let loads = html.replace("xmlns=\"http://www.w3.org/2000/svg\"", "");
        for remote in ["http", "src=", "href=", "<script", "@import", "url("] {
            assert!(!loads.contains(remote), "{remote}: {html}");
        }
        assert_eq!(with_code("a `b` c"), "a <code>b</code> c");
    }
}
