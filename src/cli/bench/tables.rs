//! What was measured on a scene as a section.

use super::measure::{Measured, Method, peak_memory};
use super::words::{interval, number, reading, target};
use serde_json::{Value, json};
use steradian::bench::{
    Clock, Curve, Figure, Interval, Plot, PlotPoint, Section, Series, Table, resample,
};

/// Both kinds of seconds.
pub(super) const CLOCKS: [Clock; 2] = [Clock::Cpu, Clock::Wall];

/// A scene's section.
pub(super) fn section(measured: &Measured, targets: &[f64], times: &[f64]) -> Section {
    let mut text = vec![about(measured)];
    text.extend(measured.notes.iter().cloned());
    let mut tables =
        vec![points(measured), equal_error(measured, targets), equal_time(measured, times)];
    tables.push(decomposition(measured));
    tables.push(facts(measured));
    Section {
        title: measured.name.clone(),
        text,
        tables,
        figures: CLOCKS.map(|clock| figure(measured, clock)).into(),
        data: data(measured, targets),
        sections: Vec::new(),
    }
}

fn about(measured: &Measured) -> String {
    let (width, height) = measured.settings.resolution;
    let bounces = match measured.settings.max_bounces {
        Some(n) => format!("at most {n} scattering events"),
        None => "no limit of bounces".into(),
    };
    let mut text =
        format!("{width}x{height}, {bounces}, {} runs of each point. ", rounds(measured));
    let smallest = measured.methods.iter().map(least_error).fold(f64::INFINITY, f64::min);
    for reference in &measured.references {
        let own = match reference.relmse {
            Some(own) => format!(
                "its own variance adds {} to every relMSE, {:.1} % of the smallest below, and is taken off",
                number(own),
                100.0 * own / smallest
            ),
            None => "its own variance is not known, and not taken off".into(),
        };
        text +=
            &format!("Reference ({}): {own}; ε = {}. ", reference.name, number(reference.epsilon));
    }
    if let Some(d) = &measured.difference {
        text += &format!(
            "Each renderer is measured against its own reference. They differ by {:+.3} % in the mean, \
             {:.1} standard errors, and pixel by pixel, beyond their noise, by a relMSE of {} \
             (standard error {}).",
            100.0 * d.mean,
            d.mean_in_standard_errors,
            number(d.relmse),
            number(d.relmse_standard_error)
        );
    }
    text
}

fn rounds(measured: &Measured) -> usize {
    measured.methods[0].curve.rounds()
}

fn least_error(method: &Method) -> f64 {
    let last = method.curve.points.len() - 1;
    method.curve.error_interval(last).value
}

fn points(measured: &Measured) -> Table {
    let mut table = Table::new(
        "Points: means over the runs with 95 % intervals; seconds are the median, least and largest. The \
         reference's variance is taken off the first form of the error alone.",
        &[
            "method",
            "spp",
            "relMSE",
            "without the worst 0.1 % (their share)",
            "(x-r)²/(r+0.01)²",
            "CPU s",
            "wall s",
        ],
    );
    for method in &measured.methods {
        for (i, errors) in method.errors.iter().enumerate() {
            let n = errors.len() as f64;
            let mean = |of: fn(&steradian::bench::PictureErrors) -> f64| {
                errors.iter().map(of).sum::<f64>() / n
            };
            let range = |clock| {
                let [least, middle, most] = method.curve.time_range(i, clock);
                format!("{} ({} to {})", number(middle), number(least), number(most))
            };
            let trimmed =
                format!("{} ({:.1} %)", number(mean(|e| e.trimmed)), 100.0 * mean(|e| e.removed));
            table.row([
                method.curve.name.clone(),
                number(method.curve.points[i].samples),
                interval(&method.curve.error_interval(i)),
                trimmed,
                number(mean(|e| e.offset)),
                range(Clock::Cpu),
                range(Clock::Wall),
            ]);
        }
    }
    table
}

fn equal_error(measured: &Measured, targets: &[f64]) -> Table {
    let mut columns = vec!["method".to_owned(), "slope".into()];
    for clock in CLOCKS {
        columns.extend(targets.iter().map(|t| format!("{} to {}", clock.name(), target(*t))));
    }
    let mut table = Table {
        title: "Slope: exponent of the error's growth with the samples, -1 for 1/n. Seconds to a relMSE, \
                between the points by the logarithms; ~ is beyond them, as if error × seconds were constant."
            .into(),
        columns,
        rows: Vec::new(),
    };
    for Method { curve, .. } in &measured.methods {
        let mut cells = vec![curve.name.clone(), interval(&curve.slope())];
        for clock in CLOCKS {
            cells.extend(targets.iter().map(|t| reading(&curve.seconds_to(*t, clock))));
        }
        table.row(cells);
    }
    table
}

fn equal_time(measured: &Measured, times: &[f64]) -> Table {
    let mut columns = vec!["method".to_owned()];
    for clock in CLOCKS {
        columns.extend(times.iter().map(|t| format!("relMSE after {t} {}", clock.name())));
    }
    let mut table = Table { title: "Error at equal time.".into(), columns, rows: Vec::new() };
    for Method { curve, .. } in &measured.methods {
        let mut cells = vec![curve.name.clone()];
        for clock in CLOCKS {
            cells.extend(times.iter().map(|t| reading(&curve.error_after(*t, clock))));
        }
        table.row(cells);
    }
    table
}

/// Cost of a sample, ns, at a point: pixels of the window times samples.
pub(super) fn cost_per_sample(curve: &Curve, point: usize, clock: Clock, pixels: f64) -> Interval {
    let samples = curve.points[point].samples * pixels;
    resample(curve.rounds(), |rounds| 1e9 * curve.seconds(point, clock, rounds) / samples)
}

pub(super) fn pixels(measured: &Measured) -> f64 {
    let window = measured.settings.window();
    f64::from(window.width) * f64::from(window.height)
}

fn decomposition(measured: &Measured) -> Table {
    let mut table = Table::new(
        "Why: what a sample costs times what it is worth, at the most samples. Efficiency: 1 / (relMSE × CPU \
         seconds), beside the first method.",
        &[
            "method",
            "CPU ns/sample",
            "wall ns/sample",
            "relMSE × samples",
            "rays/path, closest",
            "rays/path, shadow",
            "M rays/s",
            "efficiency",
        ],
    );
    let first = &measured.methods[0].curve;
    for Method { curve, counts, .. } in &measured.methods {
        let last = curve.points.len() - 1;
        let cost = |clock| interval(&cost_per_sample(curve, last, clock, pixels(measured)));
        let per_path = |of: fn(&steradian::renderer::RenderStatistics) -> u64| {
            counts.as_ref().map_or("–".into(), |c| number(of(c) as f64 / c.samples as f64))
        };
        let rays = counts.as_ref().map_or("–".into(), |c| {
            number((c.closest_rays + c.shadow_rays) as f64 / c.render_seconds / 1e6)
        });
        table.row([
            curve.name.clone(),
            cost(Clock::Cpu),
            cost(Clock::Wall),
            interval(&curve.variance_per_sample(last)),
            per_path(|c| c.closest_rays),
            per_path(|c| c.shadow_rays),
            rays,
            interval(&efficiency(curve, first, Clock::Cpu)),
        ]);
    }
    table
}

/// 1 / (error × seconds) at the last points, over that of `base`.
pub(super) fn efficiency(curve: &Curve, base: &Curve, clock: Clock) -> Interval {
    let of = |curve: &Curve, rounds: &[usize]| {
        let last = curve.points.len() - 1;
        curve.mean_error(last, rounds) * curve.seconds(last, clock, rounds)
    };
    resample(curve.rounds().min(base.rounds()), |rounds| of(base, rounds) / of(curve, rounds))
}

fn facts(measured: &Measured) -> Table {
    let (facts, s) = (&measured.facts, &measured.facts.statistics);
    let mut table = Table::new("Apart from sampling.", &["", ""]);
    let faults: u64 = s.faults.iter().sum();
    let rows = [
        (
            "seconds to load, to build trees, to compile",
            format!(
                "{}, {}, {}",
                number(facts.load_seconds),
                number(facts.build_seconds),
                number(facts.compile_seconds)
            ),
        ),
        (
            "triangles, spheres, instances",
            format!("{}, {}, {}", s.triangle_count, s.sphere_count, s.instance_count),
        ),
        (
            "nodes, levels, SAH cost",
            format!("{}, {}, {}", s.node_count, s.tree_depth, number(s.sah_cost)),
        ),
        ("node and primitive tests of a camera ray", facts.visits.map(number).join(", ")),
        ("MiB of the scene on the device", number(s.device_bytes as f64 / 1_048_576.0)),
        ("most memory of the process so far", peak_memory()),
        ("lines of the kernel", s.wgsl_lines.to_string()),
        ("faulty samples of the last run", faults.to_string()),
    ];
    for (name, value) in rows {
        table.row([name.into(), value]);
    }
    if let Some(seconds) = facts.rival_load_seconds {
        table.row(["seconds that the other renderer takes to load".into(), number(seconds)]);
    }
    table
}

fn figure(measured: &Measured, clock: Clock) -> Figure {
    let series = measured.methods.iter().map(|Method { curve, .. }| {
        let of = |p: usize| {
            let error = curve.error_interval(p);
            let x = curve.time_range(p, clock)[1];
            PlotPoint { x, y: error.value, low: error.low, high: error.high }
        };
        Series { name: curve.name.clone(), points: (0..curve.points.len()).map(of).collect() }
    });
    let word = if clock == Clock::Wall { "wall" } else { "cpu" };
    Figure {
        name: format!("{}-{word}", measured.name),
        caption: format!(
            "{}: error against {}; the dashed line falls as 1/t",
            measured.name,
            clock.name()
        ),
        plot: Plot {
            title: measured.name.clone(),
            x_label: clock.name().into(),
            y_label: "relMSE".into(),
            series: series.collect(),
            guide: Some(-1.0),
        },
    }
}

fn data(measured: &Measured, targets: &[f64]) -> Value {
    let references = measured
        .references
        .iter()
        .map(|r| json!({ "name": r.name, "relmse": r.relmse, "epsilon": r.epsilon }));
    let methods = measured.methods.iter().map(|m| {
        let to = |t: &f64| {
            let [cpu, wall] = CLOCKS.map(|clock| m.curve.seconds_to(*t, clock));
            json!({ "relmse": t, "cpu": cpu, "wall": wall })
        };
        let rays = m.counts.as_ref().map(|c| {
            json!({
                "samples": c.samples, "closest": c.closest_rays, "shadow": c.shadow_rays,
                "seconds": c.render_seconds,
            })
        });
        json!({
            "name": m.curve.name, "points": m.curve.points, "errors": m.errors, "slope": m.curve.slope(),
            "seconds_to": targets.iter().map(to).collect::<Vec<_>>(), "rays": rays,
        })
    });
    let (facts, s) = (&measured.facts, &measured.facts.statistics);
    json!({
        "scene": measured.name,
        "resolution": measured.settings.resolution,
        "max_bounces": measured.settings.max_bounces,
        "references": references.collect::<Vec<_>>(),
        "difference": measured.difference,
        "load_seconds": facts.load_seconds,
        "bvh_seconds": facts.build_seconds,
        "compile_seconds": facts.compile_seconds,
        "node_tests_per_camera_ray": facts.visits[0],
        "primitive_tests_per_camera_ray": facts.visits[1],
        "triangles": s.triangle_count,
        "nodes": s.node_count,
        "sah_cost": s.sah_cost,
        "device_bytes": s.device_bytes,
        "wgsl_lines": s.wgsl_lines,
        "notes": measured.notes,
        "methods": methods.collect::<Vec<_>>(),
    })
}
