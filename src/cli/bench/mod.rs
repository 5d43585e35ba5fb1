//! `steradian bench`: speed against error, and how well stopping rules keep their word.

mod child;
mod clock;
mod coverage;
mod flags;
mod headline;
mod lane;
mod measure;
mod mitsuba;
mod scale;
mod specialise;
mod startup;
mod tables;
mod variants;
mod words;

pub(crate) use flags::BenchFlags;

use super::destination::check_place;
use super::job::Job;
use super::talk;
use std::cell::RefCell;
use std::path::Path;
use std::process::ExitCode;
use std::rc::Rc;
use std::sync::Arc;
use steradian::bench::{Section, markdown, page};
use steradian::gpu::Device;
use steradian::image::write_atomically;
use steradian::passes::FloatEnvironment;
use steradian::{Error, Result};

/// Measures what is asked for.
pub(super) fn run(flags: &BenchFlags) -> Result<ExitCode> {
    let files = [&flags.json, &flags.report, &flags.markdown];
    files.into_iter().flatten().try_for_each(|path| check_place(path))?;
    if flags.coverage {
        return coverage::run(flags);
    }
    check(flags)?;
    let server = flags.against.map(|_| mitsuba::Server::start(&flags.python)).transpose()?;
    let server = server.map(|server| Rc::new(RefCell::new(server)));
    let device = Arc::new(Device::open(flags.device.as_deref())?);
    let mut report = Section {
        title: "Speed against error".into(),
        text: about(&device)?,
        ..Section::default()
    };
    let mut all = Vec::new();
    for (i, scene) in flags.scenes.iter().enumerate() {
        let with_variants = flags.ablation.is_some_and(|n| i < n);
        all.push(measure::measure(scene, flags, &device, server.as_ref(), with_variants)?);
    }
    if !all.is_empty() {
        report.tables.push(headline::summary(&all, &flags.targets));
    }
    if let Some(server) = &server {
        let version = server.borrow().version.clone();
        report.sections.extend(headline::against(&all, &flags.targets, &version));
    }
    report.sections.extend(headline::ablation(&all));
    let scenes = all.iter().map(|m| tables::section(m, &flags.targets, &flags.times));
    report.sections.extend(scenes);
    if flags.specialise.is_some() {
        report.sections.push(specialise::section(flags, &device)?);
    }
    if flags.startup {
        report.sections.push(startup::section(flags)?);
    }
    report.sections.extend(scale::sections(flags, &device)?);
    write(&report, flags)?;
    Ok(ExitCode::SUCCESS)
}

/// What would only be found out after hours.
fn check(flags: &BenchFlags) -> Result<()> {
    let needs_scenes = [
        (flags.against.is_some(), "--against"),
        (flags.ablation.is_some(), "--ablation"),
        (flags.specialise.is_some(), "--specialise"),
        (flags.startup, "--startup"),
        (flags.scale.contains(&flags::Scale::Threads), "--scale threads"),
    ];
    if let Some((_, flag)) = needs_scenes.iter().find(|(is_given, _)| *is_given)
        && flags.scenes.is_empty()
    {
        return Err(Error::Settings(format!("{flag}: needs a scene")));
    }
    if flags.sampling.reference {
        let message = "--reference: bench measures the renderer; --reference-file names the picture that \
                       errors are measured against";
        return Err(Error::Settings(message.into()));
    }
    if flags.against.is_some() && !flags.sees_the_file() {
        let message = "--against: the other renderer sees the scene as its file says, without --crop, \
                       --only-bounce, and the flags of scene, camera and environment";
        return Err(Error::Settings(message.into()));
    }
    // The loader knows how to say that a file is not there.
    let missing = flags.scenes.iter().find(|path| !path.is_file());
    missing.map_or(Ok(()), |path| Job::new(path, &flags.job(1)).map(drop))
}

/// The machine, and how it was measured.
fn about(device: &Device) -> Result<Vec<String>> {
    let info = device.info();
    let processor = clock::processor().unwrap_or_else(|| "an unknown processor".into());
    let environment = FloatEnvironment::of(device)?;
    let threads = std::env::var("LP_NUM_THREADS").unwrap_or_else(|_| "all".into());
    Ok(vec![
        format!(
            "{}, {}, on {processor}, {} threads (LP_NUM_THREADS: {threads}); float environment {environment}; \
             Steradian {}.",
            info.name,
            info.driver.trim(),
            clock::threads(),
            env!("CARGO_PKG_VERSION"),
        ),
        "relMSE is the mean over pixels and channels of (x - r)² / (r² + ε), ε = (0.01 × mean luminance)². \
         Every point is several renders with seeds of their own, after one that is not counted; methods take \
         turns within a round, and every other round runs backwards. Seconds are those of sampling, from \
         before the first dispatch until the picture is read; loading, building and compiling stand apart. CPU \
         seconds are of the process on all cores. Intervals are at 95 %, by resampling the runs."
            .into(),
    ])
}

/// To standard output, and to the files that are named.
fn write(report: &Section, flags: &BenchFlags) -> Result<()> {
    talk::data(&markdown(report, None))?;
    if let Some(path) = &flags.json {
        let json = serde_json::to_string_pretty(report).map_err(|e| Error::io(path, e.into()))?;
        put(path, &json)?;
    }
    if let Some(path) = &flags.report {
        put(path, &page(report))?;
    }
    if let Some(path) = &flags.markdown {
        let folder = path.with_extension("");
        std::fs::create_dir_all(&folder).map_err(|e| Error::io(&folder, e))?;
        for figure in report.all_figures() {
            put(&folder.join(format!("{}.svg", figure.name)), &figure.plot.svg())?;
        }
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        put(path, &markdown(report, Some(&name)))?;
    }
    Ok(())
}

fn put(path: &Path, text: &str) -> Result<()> {
    write_atomically(path, |file| {
        use std::io::Write;
        file.write_all(text.as_bytes()).map_err(|e| Error::io(path, e))
    })
}
