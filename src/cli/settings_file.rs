//! Settings from a file and from `--set`: the flags of `render` by their long names.
//!
//! They become words of the command line before it is read, so that each value is checked as a flag
//! is. A flag that is given wins over `--set`, and that over the file; what would contradict the
//! winner is left out with the loser. A value of `null` is none.

use super::flags::RenderFlags;
use clap::parser::ValueSource;
use clap::{Arg, ArgAction, ArgMatches, Args, Command};
use serde_json::{Map, Value};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use steradian::{Error, Result};

/// Flags that are no settings.
const NO_SETTINGS: [&str; 5] = ["settings", "set", "dump-settings", "help", "version"];

/// Least likeness of a name that is suggested (Jaro and Winkler).
const LIKENESS: f64 = 0.75;

/// The command line with the settings that its flags leave open.
///
/// # Errors
/// [`Error::Settings`] for keys that there are not, and for values that are none;
/// [`Error::Io`].
pub(crate) fn expand(mut words: Vec<OsString>) -> Result<Vec<OsString>> {
    if words.get(1).is_none_or(|word| word != "render") {
        return Ok(words);
    }
    let command = command();
    // Whatever is wrong is told when the whole is read.
    let given = command.clone().ignore_errors(true).try_get_matches_from(&words[1..]);
    let Ok(given) = given else { return Ok(words) };
    let mut taken: Vec<&Arg> = settings(&command)
        .filter(|arg| given.value_source(arg.get_id().as_str()) == Some(ValueSource::CommandLine))
        .collect();
    let assignments = given.get_many::<String>("set").into_iter().flatten();
    let set = assignments.map(|text| assignment(text)).collect();
    let file = given.get_one::<PathBuf>("settings").map_or(Ok(Map::new()), |path| read(path));
    for (source, values) in [("--set", set), ("--settings", file?)] {
        let mut added = Vec::new();
        for (key, value) in &values {
            let arg = find(&command, source, key)?;
            if taken.iter().any(|other| is_at_odds(&command, arg, other)) || is_default(arg, value)
            {
                added.push(arg);
                continue;
            }
            let new = to_words(arg, value)
                .ok_or_else(|| Error::Settings(format!("{source}: {key}: {value} is no value")))?;
            words.extend(new);
            added.push(arg);
        }
        taken.extend(added);
    }
    Ok(words)
}

/// Every setting with its value, as JSON that [`expand`] reads.
pub(crate) fn dump(matches: &ArgMatches) -> String {
    let command = command();
    let members = settings(&command).map(|arg| (long(arg).to_owned(), value_of(arg, matches)));
    let object = Value::Object(members.collect());
    format!("{object:#}\n")
}

fn command() -> Command {
    RenderFlags::augment_args(Command::new("render"))
}

/// Flags that are settings.
fn settings(command: &Command) -> impl Iterator<Item = &Arg> {
    command.get_arguments().filter(|a| a.get_long().is_some_and(|l| !NO_SETTINGS.contains(&l)))
}

fn long(arg: &Arg) -> &str {
    arg.get_long().unwrap_or_default()
}

/// `key=value`; a key alone is a flag that is on.
fn assignment(text: &str) -> (String, Value) {
    match text.split_once('=') {
        Some((key, value)) => (key.to_owned(), Value::String(value.to_owned())),
        None => (text.to_owned(), Value::Bool(true)),
    }
}

fn read(path: &Path) -> Result<Map<String, Value>> {
    let bytes = std::fs::read(path).map_err(|e| Error::io(path, e))?;
    match serde_json::from_slice(&bytes) {
        Ok(Value::Object(members)) => Ok(members),
        Ok(_) => Err(Error::Settings(format!("{}: not a JSON object", path.display()))),
        Err(e) => Err(Error::Settings(format!("{}: no JSON: {e}", path.display()))),
    }
}

fn find<'a>(command: &'a Command, source: &str, key: &str) -> Result<&'a Arg> {
    if let Some(arg) = settings(command).find(|arg| arg.get_long() == Some(key)) {
        return Ok(arg);
    }
    let likeness = |arg: &&Arg| strsim::jaro_winkler(long(arg), key);
    let nearest = settings(command).max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    let hint = nearest.filter(|arg| likeness(arg) >= LIKENESS);
    let hint = hint.map_or(String::new(), |arg| format!("; did you mean {:?}?", long(arg)));
    Err(Error::Settings(format!("{source}: there is no setting {key:?}{hint}")))
}

/// Whether two flags are the same, or cannot both be given.
fn is_at_odds(command: &Command, a: &Arg, b: &Arg) -> bool {
    let excludes = |a: &Arg, b: &Arg| {
        command.get_arg_conflicts_with(a).iter().any(|other| other.get_id() == b.get_id())
    };
    a.get_id() == b.get_id() || excludes(a, b) || excludes(b, a)
}

/// Whether a value is what is there without it.
fn is_default(arg: &Arg, value: &Value) -> bool {
    match value {
        Value::Null | Value::Bool(false) => true,
        value => {
            matches!(arg.get_default_values(), [one] if text(value).is_some_and(|t| *one == *t))
        }
    }
}

/// Words of the command line; `None` for what no flag can have.
fn to_words(arg: &Arg, value: &Value) -> Option<Vec<OsString>> {
    let word = |value: &Value| Some(format!("--{}={}", long(arg), text(value)?).into());
    match (arg.get_action(), value) {
        (ArgAction::SetTrue, Value::Bool(true)) => Some(vec![format!("--{}", long(arg)).into()]),
        (ArgAction::SetTrue, Value::String(text)) => match text.as_str() {
            "true" => Some(vec![format!("--{}", long(arg)).into()]),
            "false" => Some(Vec::new()),
            _ => None,
        },
        (ArgAction::SetTrue, _) => None,
        (ArgAction::Append, Value::Array(values)) => values.iter().map(word).collect(),
        (_, value) => Some(vec![word(value)?]),
    }
}

/// A string or a number as it is spelt.
fn text(value: &Value) -> Option<String> {
    match value {
        Value::String(text) => Some(text.clone()),
        Value::Number(number) => Some(number.to_string()),
        _ => None,
    }
}

fn value_of(arg: &Arg, matches: &ArgMatches) -> Value {
    let id = arg.get_id().as_str();
    if let ArgAction::SetTrue = arg.get_action() {
        return Value::Bool(matches.get_flag(id));
    }
    let values = matches.get_raw(id).into_iter().flatten();
    let mut values: Vec<Value> = values.map(|v| spelt(&v.to_string_lossy())).collect();
    match arg.get_action() {
        ArgAction::Append => Value::Array(values),
        _ => values.pop().unwrap_or(Value::Null),
    }
}

/// A number, where it is spelt as JSON spells it; else a string.
fn spelt(text: &str) -> Value {
    match text.parse::<serde_json::Number>() {
        Ok(number) if number.to_string() == text => Value::Number(number),
        _ => Value::String(text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn words(text: &str) -> Vec<OsString> {
        text.split(' ').map(Into::into).collect()
    }

    /// What the command line comes to.
    fn dumped(text: &str) -> Value {
        let words = expand(words(text)).unwrap();
        let matches = command().try_get_matches_from(&words[1..]).unwrap_or_else(|e| panic!("{e}"));
        serde_json::from_str(&dump(&matches)).unwrap()
    }

    #[test]
    fn every_flag_is_in_the_dump() {
        let dump = dumped("steradian render a.glb -o a.png");
        let dump = dump.as_object().unwrap();
        let command = command();
        let longs: Vec<_> = command.get_arguments().filter_map(|arg| arg.get_long()).collect();
        for long in &longs {
            assert_eq!(dump.contains_key(*long), !NO_SETTINGS.contains(long), "{long}");
        }
        assert!(longs.len() > 50 && dump.keys().all(|key| longs.contains(&key.as_str())));
    }

    #[test]
    fn what_is_set_arrives() {
        let base = "steradian render a.glb -o a.png";
        let set = "--set spp=7 --set no-roulette --set exposure=-2 --set frames=1-3";
        let dump = dumped(&format!("{base} {set} --set allow-external=x --set strict=false"));
        assert_eq!(dump["spp"], 7);
        assert_eq!(dump["no-roulette"], true);
        assert_eq!(dump["strict"], false);
        assert_eq!(dump["exposure"], -2);
        assert_eq!(dump["frames"], "1-3");
        assert_eq!(dump["allow-external"], serde_json::json!(["x"]));
        assert_eq!(dumped(&format!("{base} --spp 3 {set}"))["spp"], 3);
        // The flag contradicts what is set, and wins.
        let other = dumped("steradian render a.glb --pixel 1,2 --set crop=0,0,1,1");
        assert_eq!(other["crop"], Value::Null);
    }

    #[test]
    fn what_is_no_setting_is_told() {
        let cases = [
            ("--set spps=3", "no setting \"spps\"; did you mean \"spp\"?"),
            ("--set max_bounces=3", "did you mean \"max-bounces\"?"),
            ("--set xyzzy=1", "no setting \"xyzzy\""),
            ("--set settings=a.json", "no setting"),
            ("--set no-roulette=maybe", "no-roulette: \"maybe\" is no value"),
            ("--set spp", "spp: true is no value"),
            ("--settings /", "/"),
        ];
        for (flags, message) in cases {
            let error = expand(words(&format!("steradian render a.glb -o a.png {flags}")));
            let error = error.unwrap_err().to_string();
            assert!(error.contains(message), "{flags}: {error}");
        }
    }
}
