//! KHR_materials_variants: which material a primitive wears.

use super::document::Document;
use super::members::Members;
use crate::Result;
use gltf::json::mesh::Primitive;
use gltf::json::{self, Index};

const NAME: &str = "KHR_materials_variants";

/// The file's variants and the chosen one.
pub(super) struct Variants {
    /// In the file's order.
    pub(super) names: Vec<String>,
    chosen: Option<u32>,
}

impl Variants {
    /// Reads the names, and finds that of `wanted`.
    pub(super) fn read(document: &Document, wanted: Option<&str>) -> Result<Self> {
        let names = names(document).map_err(|message| document.error(message))?;
        let chosen = match wanted {
            None => None,
            Some(wanted) => match names.iter().position(|name| name == wanted) {
                Some(index) => Some(index as u32),
                None if names.is_empty() => {
                    return Err(document.error(format!("no variant {wanted:?}: it has none")));
                }
                None => {
                    let there_are = names.join(", ");
                    return Err(
                        document.error(format!("no variant {wanted:?}; there are: {there_are}"))
                    );
                }
            },
        };
        Ok(Self { names, chosen })
    }

    /// The primitive's material in the chosen variant, if that gives it another.
    pub(super) fn material(
        &self,
        document: &Document,
        primitive: &Primitive,
        what: &str,
    ) -> Result<Option<Index<json::Material>>> {
        let extension = primitive.extensions.as_ref().and_then(|e| e.others.get(NAME));
        let Some(extension) = extension else { return Ok(None) };
        let find = || {
            for mapping in Members::of(NAME, extension)?.items("mappings")? {
                let mapping = Members::of("KHR_materials_variants.mappings", mapping)?;
                let material = mapping.index("material")?.ok_or("a mapping without a material")?;
                let variants = mapping.indices("variants")?;
                if let Some(none) = variants.iter().find(|&&v| v as usize >= self.names.len()) {
                    return Err(format!(
                        "a mapping refers to variant {none}, which does not exist"
                    ));
                }
                if self.chosen.is_some_and(|chosen| variants.contains(&chosen)) {
                    return Ok(Some(Index::new(material)));
                }
            }
            Ok(None)
        };
        find().map_err(|message| document.error(format!("{what}: {message}")))
    }
}

fn names(document: &Document) -> std::result::Result<Vec<String>, String> {
    let root = Members::of("the file", &document.raw)?;
    let extensions = root.object("extensions")?;
    let variants = extensions.object(NAME)?.items("variants")?;
    let name = |(index, variant)| {
        let name = Members::of("KHR_materials_variants.variants", variant)?.text("name")?;
        Ok(name.map_or_else(|| format!("variant {index}"), str::to_owned))
    };
    variants.iter().enumerate().map(name).collect()
}
