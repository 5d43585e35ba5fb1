//! The page: one section a study, and the pictures of a study in one file.

use steradian::image::{Picture, PngOptions, linear_from_srgb, write_png};

/// Where the page lies.
pub(crate) const PAGE: &str = "docs/gallery.md";

/// Where its pictures lie.
const PICTURES: &str = "docs/gallery";

/// Pixels between pictures.
const GAP: usize = 6;

/// Level between pictures, sRGB.
const PAPER: f32 = 0.94;

/// A table of `rows` under `head`; all columns but the first are numbers.
pub(crate) fn table(head: &[&str], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let mut text = line(&head.iter().map(|h| (*h).to_owned()).collect::<Vec<_>>());
    text += &format!("|---{}|\n", "|---:".repeat(head.len() - 1));
    text.extend(rows.into_iter().map(|row| line(&row)));
    text
}

/// Commands, folded away.
pub(crate) fn commands<'a>(lines: impl IntoIterator<Item = &'a str>) -> String {
    let mut seen = Vec::new();
    lines.into_iter().for_each(|line| {
        if !seen.contains(&line) {
            seen.push(line);
        }
    });
    let lines = seen.join("\n");
    format!("<details><summary>The commands</summary>\n\n```sh\n{lines}\n```\n\n</details>\n")
}

/// Small numbers with two digits.
pub(crate) fn short(x: f64) -> String {
    if x == 0.0 { "0".into() } else { format!("{x:.1e}") }
}

/// Processor time; a tenth of a second is as fine as the clock and the start allow.
pub(crate) fn time(seconds: f64) -> String {
    if seconds < 0.1 { "< 0.1 s".into() } else { format!("{seconds:.1} s") }
}

/// Writes `pictures`, each with its exposure in stops, in rows of `columns`, every pixel
/// `zoom` times as wide and high. Gives the line that shows them.
pub(crate) fn sheet(
    name: &str,
    what: &str,
    pictures: &[(&Picture, f32)],
    columns: usize,
    zoom: usize,
) -> Result<String, String> {
    let of = |side: u32| side as usize * zoom;
    let (width, height) = (of(pictures[0].0.width), of(pictures[0].0.height));
    let rows = pictures.len().div_ceil(columns);
    let (across, down) = (columns * (width + GAP) - GAP, rows * (height + GAP) - GAP);
    let mut rgb = vec![[linear_from_srgb(PAPER); 3]; across * down];
    for (i, (picture, exposure)) in pictures.iter().enumerate() {
        let (left, top) = (i % columns * (width + GAP), i / columns * (height + GAP));
        for y in 0..height {
            for x in 0..width {
                let from = (y / zoom) * picture.width as usize + x / zoom;
                rgb[(top + y) * across + left + x] = picture.rgb[from].map(|v| v * exposure.exp2());
            }
        }
    }
    std::fs::create_dir_all(PICTURES).map_err(|e| format!("{PICTURES}: {e}"))?;
    let path = format!("{PICTURES}/{name}.png");
    let sheet = Picture::new(across as u32, down as u32, rgb);
    write_png(path.as_ref(), &sheet, &PngOptions::default()).map_err(|e| e.to_string())?;
    Ok(format!("![{what}](gallery/{name}.png)\n"))
}

/// The section of `title` in `page`, its heading included.
pub(crate) fn section(page: &str, title: &str) -> Option<String> {
    let begin = page.find(&format!("\n## {title}\n"))? + 1;
    let rest = &page[begin..];
    let end = rest[1..].find("\n## ").map_or(rest.len(), |end| end + 2);
    Some(format!("{}\n", rest[..end].trim_end()))
}
