//! All scenes together: beside another renderer, and what each part is worth.

use super::measure::{Measured, Method, PATH_REUSE};
use super::tables::{CLOCKS, cost_per_sample, efficiency, pixels};
use super::words::{interval, number, reading, target};
use serde_json::{Value, json};
use steradian::bench::{Clock, Section, Table, ratio, resample};

/// Ours beside the other program's. `None` where there is none.
pub(super) fn against(all: &[Measured], targets: &[f64], version: &str) -> Option<Section> {
    let mut data: Vec<Value> = Vec::new();
    let mut tables = Vec::new();
    for clock in CLOCKS {
        let mut columns = vec!["scene".to_owned()];
        for t in targets {
            let t = target(*t);
            columns.extend([
                format!("ours, s to {t}"),
                format!("Mitsuba, s to {t}"),
                format!("ratio at {t}"),
            ]);
        }
        let title = format!(
            "{}: to a relMSE, and ours over Mitsuba's; below 1 we are faster.",
            capital(clock)
        );
        let mut table = Table { title, columns, rows: Vec::new() };
        for measured in all {
            let (all_ours, theirs) = pairs(measured)?;
            for ours in all_ours {
                let mut cells = vec![row_name(measured, ours)];
                for &t in targets {
                    let ratio = ratio(&ours.curve, &theirs.curve, t, clock)?;
                    let [a, b] = [ours, theirs].map(|m| m.curve.seconds_to(t, clock));
                    cells.extend([reading(&a), reading(&b), reading(&ratio)]);
                    data.push(json!({
                        "scene": measured.name, "method": ours.curve.name, "clock": clock, "relmse": t,
                        "ours": a, "rival": b, "ratio": ratio,
                    }));
                }
                table.row(cells);
            }
        }
        tables.push(table);
    }
    tables.push(why(all)?);
    let text = vec![format!(
        "{version}, box filter, in the same run by turns, on the same scenes by `tools/mitsuba_scene.py`. Each \
         renderer's error is measured against its own reference; how far those are from each other stands \
         with each scene. Intervals at 95 % by resampling the rounds, the same for both."
    )];
    let title = "Beside Mitsuba 3".into();
    Some(Section { title, text, tables, data: json!(data), ..Section::default() })
}

fn capital(clock: Clock) -> &'static str {
    match clock {
        Clock::Cpu => "CPU seconds",
        Clock::Wall => "Wall seconds",
    }
}

/// The default method and the one beside it, and the other program's.
fn pairs(measured: &Measured) -> Option<(Vec<&Method>, &Method)> {
    let ours = |(i, m): &(usize, &Method)| *i == 0 || m.curve.name == PATH_REUSE;
    let all_ours = measured.methods.iter().enumerate().filter(ours).map(|(_, m)| m).collect();
    Some((all_ours, measured.methods.iter().find(|m| m.is_rival)?))
}

fn row_name(measured: &Measured, ours: &Method) -> String {
    match ours.curve.name.as_str() {
        PATH_REUSE => format!("{}, {PATH_REUSE}", measured.name),
        _ => measured.name.clone(),
    }
}

/// The ratio of seconds as cost per sample × variance per sample.
fn why(all: &[Measured]) -> Option<Table> {
    let mut table = Table::new(
        "Why, at the most samples: ours over Mitsuba's.",
        &[
            "scene",
            "CPU cost of a sample",
            "wall cost of a sample",
            "variance of a sample",
            "product, CPU",
            "product, wall",
        ],
    );
    for measured in all {
        let (all_ours, theirs) = pairs(measured)?;
        for ours in all_ours {
            let last = ours.curve.points.len() - 1;
            let per = |clock| {
                let of = |m: &Method, rounds: &[usize]| {
                    m.curve.seconds(last, clock, rounds) / m.curve.points[last].samples
                };
                resample(ours.curve.rounds(), |rounds| of(ours, rounds) / of(theirs, rounds))
            };
            let variance = resample(ours.curve.rounds(), |rounds| {
                let of =
                    |m: &Method| m.curve.mean_error(last, rounds) * m.curve.points[last].samples;
                of(ours) / of(theirs)
            });
            // Efficiency is 1 / (error × seconds).
            let product = |clock| interval(&efficiency(&theirs.curve, &ours.curve, clock));
            table.row([
                row_name(measured, ours),
                interval(&per(Clock::Cpu)),
                interval(&per(Clock::Wall)),
                interval(&variance),
                product(Clock::Cpu),
                product(Clock::Wall),
            ]);
        }
    }
    Some(table)
}

/// What each method is worth on each scene, beside plain path tracing.
pub(super) fn ablation(all: &[Measured]) -> Option<Section> {
    const PLAIN: &str = "no light sampling";
    let names: Vec<&String> = {
        let mut names: Vec<&String> = Vec::new();
        for method in all.iter().flat_map(|m| &m.methods).filter(|m| !m.is_rival) {
            if !names.contains(&&method.curve.name) {
                names.push(&method.curve.name);
            }
        }
        names
    };
    if names.len() < 2 {
        return None;
    }
    let find = |m: &'_ Measured, name: &str| m.methods.iter().position(|x| x.curve.name == name);
    let mut columns = vec!["method".to_owned()];
    columns.extend(all.iter().map(|m| m.name.clone()));
    columns.extend(["geometric mean".into(), "least".into()]);
    let title = "Efficiency, 1 / (relMSE × CPU seconds), over that of plain path tracing, with neither light \
                 sampling nor MIS.";
    let mut plain = Table { title: title.into(), columns: columns.clone(), rows: Vec::new() };
    let title = "Efficiency over that of the default: below 1, what was switched off pays.";
    let mut beside = Table { title: title.into(), columns, rows: Vec::new() };
    for name in names {
        let row = |base: &str| {
            let mut values = Vec::new();
            let mut cells = vec![name.clone()];
            for measured in all {
                let found = find(measured, name).zip(find(measured, base));
                let cell = found.map(|(a, b)| {
                    let [a, b] = [a, b].map(|i| &measured.methods[i].curve);
                    efficiency(a, b, Clock::Cpu)
                });
                cells.push(cell.as_ref().map_or("–".into(), interval));
                values.extend(cell.map(|c| (c.value, &measured.name)));
            }
            let known: Vec<_> = values.iter().filter(|v| v.0 > 0.0).collect();
            let mean = known.iter().map(|v| v.0.ln()).sum::<f64>() / known.len() as f64;
            let least = known.iter().min_by(|a, b| a.0.total_cmp(&b.0));
            cells.push(number(mean.exp()));
            cells.push(least.map_or("–".into(), |(v, scene)| format!("{} ({scene})", number(*v))));
            cells
        };
        plain.row(row(PLAIN));
        beside.row(row("default"));
    }
    let title = "What each part is worth".into();
    Some(Section { title, tables: vec![beside, plain], ..Section::default() })
}

/// One line a scene for those who do not open the page.
pub(super) fn summary(all: &[Measured], targets: &[f64]) -> Table {
    let mut columns = vec!["scene".to_owned(), "CPU ns/sample".into(), "slope".into()];
    columns.extend(targets.iter().map(|t| format!("CPU s to {}", target(*t))));
    columns.extend(targets.iter().map(|t| format!("wall s to {}", target(*t))));
    let mut table = Table { title: "The default method.".into(), columns, rows: Vec::new() };
    for measured in all {
        let curve = &measured.methods[0].curve;
        let last = curve.points.len() - 1;
        let cost = cost_per_sample(curve, last, Clock::Cpu, pixels(measured));
        let mut cells = vec![measured.name.clone(), interval(&cost), interval(&curve.slope())];
        for clock in CLOCKS {
            cells.extend(targets.iter().map(|t| reading(&curve.seconds_to(*t, clock))));
        }
        table.row(cells);
    }
    table
}
