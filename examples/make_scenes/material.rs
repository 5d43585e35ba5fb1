//! Materials as the scenes describe them, and as glTF writes them.

use crate::document::rounded;
use serde_json::{Map, Value, json};

/// A surface. The default is a white Lambertian one.
pub(crate) struct Material {
    pub(crate) name: &'static str,
    /// Linear base colour.
    pub(crate) base_color: [f64; 3],
    pub(crate) metallic: f64,
    pub(crate) roughness: f64,
    /// KHR_materials_specular's specularFactor: 0 takes the dielectric's
    /// reflection away and leaves pure Lambert.
    pub(crate) specular: f64,
    /// Emitted radiance, W/(sr m²).
    pub(crate) emission: [f64; 3],
    pub(crate) double_sided: bool,
    /// Thickness in metres of a clear solid of index 1.5.
    pub(crate) glass_thickness: Option<f64>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "white",
            base_color: [1.0; 3],
            metallic: 0.0,
            roughness: 1.0,
            specular: 0.0,
            emission: [0.0; 3],
            double_sided: false,
            glass_thickness: None,
        }
    }
}

impl Material {
    /// The glTF object, and the names of the extensions that it uses.
    pub(crate) fn to_json(&self) -> (Value, Vec<&'static str>) {
        let mut extensions: Vec<(&'static str, Value)> = Vec::new();
        let [r, g, b] = self.base_color;
        let mut value = json!({
            "name": self.name,
            "pbrMetallicRoughness": {
                "baseColorFactor": [r, g, b, 1.0],
                "metallicFactor": self.metallic,
                "roughnessFactor": self.roughness,
            },
        });
        let strength = self.emission.iter().fold(0.0_f64, |a, &b| a.max(b));
        if strength > 1.0 {
            // Nine digits are more than an f32 has.
            value["emissiveFactor"] = json!(self.emission.map(|e| rounded(e / strength, 9)));
            let strength = json!({ "emissiveStrength": rounded(strength, 9) });
            extensions.push(("KHR_materials_emissive_strength", strength));
        } else if strength > 0.0 {
            value["emissiveFactor"] = json!(self.emission);
        }
        if self.double_sided {
            value["doubleSided"] = json!(true);
        }
        if self.specular != 1.0 {
            let factor = json!({ "specularFactor": self.specular });
            extensions.push(("KHR_materials_specular", factor));
        }
        if let Some(thickness) = self.glass_thickness {
            extensions.push(("KHR_materials_ior", json!({ "ior": 1.5 })));
            let factor = json!({ "transmissionFactor": 1.0 });
            extensions.push(("KHR_materials_transmission", factor));
            let factor = json!({ "thicknessFactor": thickness });
            extensions.push(("KHR_materials_volume", factor));
        }
        let names = extensions.iter().map(|(name, _)| *name).collect();
        if !extensions.is_empty() {
            let object: Map<String, Value> =
                extensions.into_iter().map(|(name, value)| (name.to_owned(), value)).collect();
            value["extensions"] = Value::Object(object);
        }
        (value, names)
    }
}
