//! Plots of logarithms over logarithms, as SVG.

use serde::Serialize;
use std::fmt::Write;

/// Width and height, and the frame's distances to left, right, top and bottom, in SVG's units.
const SIZE: (f64, f64) = (640.0, 420.0);
const MARGIN: [f64; 4] = [70.0, 160.0, 34.0, 48.0];
/// Colours of series one after the other: Okabe and Ito 2008, apart for all kinds of sight.
const COLORS: [&str; 8] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000", "#8c6d31"];

/// A mark with its interval; an end that is not a number is not drawn.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct PlotPoint {
    /// Across.
    pub x: f64,
    /// Up.
    pub y: f64,
    /// Lower end of y's interval.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

/// Points that are joined.
#[derive(Debug, Clone, Serialize)]
pub struct Series {
    /// In the legend.
    pub name: String,
    /// From left to right. Those that are not positive are left out.
    pub points: Vec<PlotPoint>,
}

/// What is drawn. Both axes are logarithmic.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Plot {
    /// Above the frame.
    pub title: String,
    /// Below it.
    pub x_label: String,
    /// To the left of it.
    pub y_label: String,
    /// In the order of the legend.
    pub series: Vec<Series>,
    /// Exponent of a dashed line through the first point of the first series.
    pub guide: Option<f64>,
}

/// A range of decades, and where it is in the picture.
struct Axis {
    low: f64,
    high: f64,
    from: f64,
    to: f64,
}

impl Axis {
    fn new(values: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let logs = values.filter(|v| *v > 0.0 && v.is_finite()).map(f64::log10);
        let (low, high) =
            logs.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(v), b.max(v)));
        if low > high {
            return Self { low: 0.0, high: 1.0, from, to };
        }
        // At least a third of a decade, with a margin.
        let half = (0.5 * (high - low)).max(1.0 / 6.0) * 1.06;
        let middle = 0.5 * (low + high);
        Self { low: middle - half, high: middle + half, from, to }
    }

    fn at(&self, value: f64) -> f64 {
        self.from + (value.log10() - self.low) / (self.high - self.low) * (self.to - self.from)
    }

    /// Marks: powers of ten, and 2 and 5 times those where the range is short.
    fn ticks(&self) -> Vec<f64> {
        let factors: &[f64] = if self.high - self.low > 2.5 { &[1.0] } else { &[1.0, 2.0, 5.0] };
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        decades
            .flat_map(|d| factors.iter().map(move |f| f * 10f64.powi(d)))
            .filter(|v| (self.low..=self.high).contains(&v.log10()))
            .collect()
    }
}

/// A tick's number.
fn label(value: f64) -> String {
    match value {
        v if (0.001..10_000.0).contains(&v) => format!("{}", (v * 1e6).round() / 1e6),
        v => format!("{v:.0e}"),
    }
}

pub(super) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

impl Plot {
    /// The whole picture as one SVG element.
    pub fn svg(&self) -> String {
        let points = || self.series.iter().flat_map(|s| &s.points).filter(|p| is_shown(p));
        let x = Axis::new(points().map(|p| p.x), MARGIN[0], SIZE.0 - MARGIN[1]);
        let y_values = points().flat_map(|p| [p.y, p.low, p.high]);
        let y = Axis::new(y_values, SIZE.1 - MARGIN[3], MARGIN[2]);
        let (width, height) = SIZE;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
             width=\"{width}\" height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#fff\"/>\n"
        );
        self.frame(&mut svg, &x, &y);
        self.guide_line(&mut svg, &x, &y);
        for (i, series) in self.series.iter().enumerate() {
            draw(&mut svg, series, i, &x, &y);
        }
        svg.push_str("</svg>\n");
        svg
    }

    fn frame(&self, svg: &mut String, x: &Axis, y: &Axis) {
        // Writing to a string cannot fail.
        for tick in x.ticks() {
            let (at, label) = (x.at(tick), label(tick));
            let _ = writeln!(
                svg,
                "<path d=\"M{at:.1} {:.1}V{:.1}\" stroke=\"#ddd\"/><text x=\"{at:.1}\" y=\"{:.1}\" \
                 text-anchor=\"middle\">{label}</text>",
                y.from,
                y.to,
                y.from + 16.0
            );
        }
        for tick in y.ticks() {
            let (at, label) = (y.at(tick), label(tick));
            let _ = writeln!(
                svg,
                "<path d=\"M{:.1} {at:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" \
                 text-anchor=\"end\">{label}</text>",
                x.from,
                x.to,
                x.from - 6.0,
                at + 4.0
            );
        }
        let middle = (0.5 * (x.from + x.to), 0.5 * (y.from + y.to));
        let _ = writeln!(
            svg,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#333\"/>\n\
             <text x=\"{:.1}\" y=\"20\" text-anchor=\"middle\" font-size=\"14\">{}</text>\n\
             <text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>\n\
             <text transform=\"translate(16 {:.1}) rotate(-90)\" text-anchor=\"middle\">{}</text>",
            x.from,
            y.to,
            x.to - x.from,
            y.from - y.to,
            middle.0,
            escaped(&self.title),
            middle.0,
            y.from + 36.0,
            escaped(&self.x_label),
            middle.1,
            escaped(&self.y_label),
        );
    }

    fn guide_line(&self, svg: &mut String, x: &Axis, y: &Axis) {
        let first = self.series.iter().flat_map(|s| &s.points).find(|p| is_shown(p));
        let (Some(exponent), Some(first)) = (self.guide, first) else { return };
        // From end to end of the frame; what leaves it above or below is cut off there.
        let (px, py) = (first.x.log10(), first.y.log10());
        let at = |log_x: f64| (log_x, py + exponent * (log_x - px));
        let ends = [x.low, x.high].map(|log_x| {
            let (lx, ly) = at(log_x);
            let inside = ly.clamp(y.low, y.high);
            if inside == ly || exponent == 0.0 {
                (lx, ly)
            } else {
                (px + (inside - py) / exponent, inside)
            }
        });
        let [a, b] = ends.map(|(lx, ly)| (x.at(10f64.powf(lx)), y.at(10f64.powf(ly))));
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\" stroke=\"#999\" stroke-dasharray=\"5 4\"/>",
            a.0, a.1, b.0, b.1
        );
    }
}

/// Whether a logarithm shows it.
fn is_shown(point: &PlotPoint) -> bool {
    [point.x, point.y].iter().all(|v| *v > 0.0 && v.is_finite())
}

fn draw(svg: &mut String, series: &Series, index: usize, x: &Axis, y: &Axis) {
    let color = COLORS[index % COLORS.len()];
    let shown: Vec<_> = series.points.iter().filter(|p| is_shown(p)).collect();
    let with_band: Vec<_> = shown.iter().filter(|p| p.low > 0.0 && p.high.is_finite()).collect();
    let corners =
        with_band.iter().map(|p| (p.x, p.high)).chain(with_band.iter().rev().map(|p| (p.x, p.low)));
    let path = |points: &mut dyn Iterator<Item = (f64, f64)>| {
        points.enumerate().fold(String::new(), |mut path, (i, (px, py))| {
            let _ =
                write!(path, "{}{:.1} {:.1}", if i == 0 { 'M' } else { 'L' }, x.at(px), y.at(py));
            path
        })
    };
    if with_band.len() > 1 {
        let band = path(&mut corners.into_iter());
        let _ = writeln!(svg, "<path d=\"{band}Z\" fill=\"{color}\" fill-opacity=\"0.18\"/>");
    }
    let line = path(&mut shown.iter().map(|p| (p.x, p.y)));
    let _ =
        writeln!(svg, "<path d=\"{line}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"1.6\"/>");
    for p in shown {
        let _ = writeln!(
            svg,
            "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"3\" fill=\"{color}\"/>",
            x.at(p.x),
            y.at(p.y)
        );
    }
    let (left, top) = (x.to + 12.0, y.to + 14.0 + 17.0 * index as f64);
    let _ = writeln!(
        svg,
        "<path d=\"M{left:.1} {:.1}h18\" stroke=\"{color}\" stroke-width=\"3\"/>\
         <text x=\"{:.1}\" y=\"{top:.1}\">{}</text>",
        top - 4.0,
        left + 24.0,
        escaped(&series.name)
    );
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(x: f64, y: f64) -> PlotPoint {
        PlotPoint { x, y, low: 0.9 * y, high: 1.1 * y }
    }

    fn plot(points: Vec<PlotPoint>) -> Plot {
        let series = vec![Series { name: "a < b".into(), points }];
        Plot { title: "t".into(), series, guide: Some(-1.0), ..Plot::default() }
    }

    /// Positions of the marks.
    fn marks(svg: &str) -> Vec<(f64, f64)> {
        let number = |line: &str, name: &str| {
            let rest = line.split(&format!("{name}=\"")).nth(1).unwrap();
            rest.split('"').next().unwrap().parse().unwrap()
        };
        let circles = svg.lines().filter(|l| l.starts_with("<circle"));
        circles.map(|l| (number(l, "cx"), number(l, "cy"))).collect()
    }

    #[test]
    fn decades_are_equally_far_apart_and_inside_the_frame() {
        let svg = plot(vec![point(0.1, 1.0), point(1.0, 0.1), point(10.0, 0.01)]).svg();
        let marks = marks(&svg);
        assert_eq!(marks.len(), 3);
        let steps = [marks[1].0 - marks[0].0, marks[2].0 - marks[1].0];
        assert!((steps[0] - steps[1]).abs() < 0.2 && steps[0] > 50.0, "{marks:?}");
        assert!(marks[0].1 < marks[1].1 && marks[1].1 < marks[2].1, "up is more: {marks:?}");
        for (x, y) in marks {
            assert!((MARGIN[0]..=SIZE.0 - MARGIN[1]).contains(&x));
            assert!((MARGIN[2]..=SIZE.1 - MARGIN[3]).contains(&y));
        }
        assert!(svg.contains("a &lt; b") && !svg.contains("NaN") && !svg.contains("inf"));
        assert!(svg.contains("stroke-dasharray"));
    }

    #[test]
    fn what_has_no_logarithm_is_left_out() {
        let odd =
            [point(1.0, 0.0), point(1.0, f64::NAN), point(-1.0, 1.0), point(f64::INFINITY, 1.0)];
        let mut points = odd.to_vec();
        points.push(PlotPoint { low: f64::NAN, high: f64::NAN, ..point(2.0, 3.0) });
        let svg = plot(points).svg();
        assert_eq!(marks(&svg).len(), 1);
        assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
        assert!(!plot(odd.to_vec()).svg().contains("NaN"));
    }
}
