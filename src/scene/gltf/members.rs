//! Members of a JSON object, read with their types checked: for the extensions that the `gltf`
//! crate has no types for, and for messages that name the member at fault.

use super::textures::Slot;
use serde::Deserialize;
use serde_json::{Map, Value};

/// A JSON object and what messages call it.
#[derive(Clone, Copy)]
pub(super) struct Members<'a> {
    name: &'a str,
    map: Option<&'a Map<String, Value>>,
}

impl<'a> Members<'a> {
    /// The members of `value`, which must be an object.
    pub(super) fn of(name: &'a str, value: &'a Value) -> Result<Self, String> {
        match value {
            Value::Object(map) => Ok(Self { name, map: Some(map) }),
            other => Err(format!("{name} must be an object, not {}", shown(other))),
        }
    }

    /// The object that is the member `key`; one without members where there is none.
    pub(super) fn object(&self, key: &'a str) -> Result<Self, String> {
        match self.get(key) {
            None => Ok(Self { name: key, map: None }),
            Some(value) => Self::of(key, value),
        }
    }

    /// The object that is the member `key`, if there is one.
    pub(super) fn optional(&self, key: &'a str) -> Result<Option<Self>, String> {
        self.get(key).map(|value| Self::of(key, value)).transpose()
    }

    /// Names of the members.
    pub(super) fn keys(&self) -> impl Iterator<Item = &'a str> {
        self.map.into_iter().flat_map(|map| map.keys().map(String::as_str))
    }

    /// Whether there is such a member.
    pub(super) fn has(&self, key: &str) -> bool {
        self.get(key).is_some()
    }

    /// A finite number.
    pub(super) fn number(&self, key: &str, default: f32) -> Result<f32, String> {
        self.get(key).map_or(Ok(default), |value| self.finite(key, value))
    }

    /// `N` finite numbers.
    pub(super) fn numbers<const N: usize>(
        &self,
        key: &str,
        default: [f32; N],
    ) -> Result<[f32; N], String> {
        let Some(value) = self.get(key) else { return Ok(default) };
        let Some(items) = value.as_array().filter(|items| items.len() == N) else {
            return Err(self.fault(key, &format!("must be {N} numbers"), value));
        };
        let mut numbers = default;
        for (number, item) in numbers.iter_mut().zip(items) {
            *number = self.finite(key, item)?;
        }
        Ok(numbers)
    }

    /// A flag.
    pub(super) fn flag(&self, key: &str) -> Result<bool, String> {
        match self.get(key) {
            None => Ok(false),
            Some(Value::Bool(flag)) => Ok(*flag),
            Some(other) => Err(self.fault(key, "must be true or false", other)),
        }
    }

    /// A word.
    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, String> {
        match self.get(key) {
            None => Ok(None),
            Some(Value::String(text)) => Ok(Some(text)),
            Some(other) => Err(self.fault(key, "must be a string", other)),
        }
    }

    /// An index.
    pub(super) fn index(&self, key: &str) -> Result<Option<u32>, String> {
        self.get(key).map(|value| self.unsigned(key, value)).transpose()
    }

    /// Indices; none where the member is missing.
    pub(super) fn indices(&self, key: &str) -> Result<Vec<u32>, String> {
        self.items(key)?.iter().map(|item| self.unsigned(key, item)).collect()
    }

    /// An array; empty where the member is missing.
    pub(super) fn items(&self, key: &str) -> Result<&'a [Value], String> {
        match self.get(key) {
            None => Ok(&[]),
            Some(Value::Array(items)) => Ok(items),
            Some(other) => Err(self.fault(key, "must be an array", other)),
        }
    }

    /// A reference to a texture.
    pub(super) fn slot(&self, key: &str) -> Result<Option<Slot>, String> {
        let Some(value) = self.get(key) else { return Ok(None) };
        Slot::deserialize(value).map(Some).map_err(|e| format!("{}.{key}: {e}", self.name))
    }

    fn get(&self, key: &str) -> Option<&'a Value> {
        self.map.and_then(|map| map.get(key))
    }

    fn unsigned(&self, key: &str, value: &Value) -> Result<u32, String> {
        let number = value.as_u64().and_then(|n| u32::try_from(n).ok());
        number.ok_or_else(|| self.fault(key, "must be an index", value))
    }

    fn finite(&self, key: &str, value: &Value) -> Result<f32, String> {
        let Some(number) = value.as_f64() else {
            return Err(self.fault(key, "must be a number", value));
        };
        // A JSON number may be too large for f32.
        match (number as f32).is_finite() {
            true => Ok(number as f32),
            false => Err(format!("{}.{key}: {number:e} is too large a number", self.name)),
        }
    }

    fn fault(&self, key: &str, rule: &str, value: &Value) -> String {
        format!("{}.{key} {rule}, not {}", self.name, shown(value))
    }
}

/// A value in messages: its beginning.
fn shown(value: &Value) -> String {
    const MOST: usize = 40;
    let text = value.to_string();
    match text.char_indices().nth(MOST) {
        None => text,
        Some((end, _)) => format!("{}…", &text[..end]),
    }
}
