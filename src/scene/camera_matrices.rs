//! Cameras as the matrices that OpenEXR files carry (ImfStandardAttributes.h): row by row, for
//! points that are rows, the translation last.

use super::{Camera, Projection};
use glam::{DMat4, DVec4};

impl Camera {
    /// `worldToCamera`: x to the right, y up, z along the view, metres; left-handed.
    pub fn world_to_camera(&self) -> [f32; 16] {
        as_floats(self.camera_from_world())
    }

    /// `worldToNDC` of a picture of `resolution`: x and y, once divided by w, are (0, 0) in the
    /// picture's upper left corner and (1, 1) in the lower right one. Through a lens it is where the
    /// ray through its centre goes.
    pub fn world_to_ndc(&self, resolution: (u32, u32)) -> [f32; 16] {
        as_floats(self.ndc_from_world(resolution))
    }

    /// For column vectors, as [`Self::world_to_ndc`] is for rows.
    pub(crate) fn ndc_from_world(&self, resolution: (u32, u32)) -> DMat4 {
        let aspect = f64::from(resolution.0) / f64::from(resolution.1);
        // z is of no use there; its choice keeps the matrix invertible.
        let (half_height, z, w) = match self.projection {
            Projection::Perspective { yfov } => ((f64::from(yfov) * 0.5).tan(), DVec4::W, DVec4::Z),
            Projection::Orthographic { ymag } => (f64::from(ymag), DVec4::Z, DVec4::W),
        };
        let x = DVec4::X * (0.5 / (half_height * aspect)) + w * 0.5;
        let y = DVec4::Y * (-0.5 / half_height) + w * 0.5;
        DMat4::from_cols(x, y, z, w).transpose() * self.camera_from_world()
    }

    fn camera_from_world(&self) -> DMat4 {
        let m = self.world_from_camera;
        let eye = m.translation.as_dvec3();
        let [x, y, z] = [m.matrix3.x_axis, m.matrix3.y_axis, -m.matrix3.z_axis]
            .map(|axis| axis.as_dvec3().extend(-axis.as_dvec3().dot(eye)));
        DMat4::from_cols(x, y, z, DVec4::W).transpose()
    }
}

/// Columns of a matrix for column vectors are the rows of that for row vectors.
fn as_floats(matrix: DMat4) -> [f32; 16] {
    matrix.to_cols_array().map(|v| v as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{Affine3A, Vec3};

    fn times(point: Vec3, m: [f32; 16]) -> [f32; 4] {
        let p = point.extend(1.0).to_array();
        std::array::from_fn(|c| (0..4).map(|r| p[r] * m[4 * r + c]).sum())
    }

    /// A camera at (1, 2, 3) that looks along -X, with +Y up: its right is -Z.
    fn camera(projection: Projection) -> Camera {
        let turn = Affine3A::from_cols(
            -Vec3::Z.to_vec3a(),
            Vec3::Y.into(),
            Vec3::X.into(),
            Vec3::new(1.0, 2.0, 3.0).into(),
        );
        Camera { world_from_camera: turn, projection, ..Camera::framing((Vec3::ZERO, Vec3::ONE)) }
    }

    #[test]
    fn the_camera_looks_along_z_and_is_left_handed() {
        let m = camera(Projection::Orthographic { ymag: 1.0 }).world_to_camera();
        assert_eq!(times(Vec3::new(1.0, 2.0, 3.0), m), [0.0, 0.0, 0.0, 1.0]);
        // 5 m ahead, 1 m to the right, 2 m up.
        assert_eq!(times(Vec3::new(-4.0, 4.0, 2.0), m), [1.0, 2.0, 5.0, 1.0]);
    }

    #[test]
    fn corners_of_the_picture_are_0_and_1() {
        let yfov = std::f32::consts::FRAC_PI_2;
        for (projection, size) in
            [(Projection::Perspective { yfov }, 4.0), (Projection::Orthographic { ymag: 1.5 }, 1.5)]
        {
            let m = camera(projection).world_to_ndc((200, 100));
            // 4 m ahead of the camera, where 90 degrees are 4 m to either side.
            let place = |right: f32, up: f32| {
                let [x, y, _, w] = times(Vec3::new(-3.0, 2.0 + up, 3.0 - right), m);
                [x / w, y / w]
            };
            for (right, up, ndc) in
                [(-2.0, 1.0, [0.0, 0.0]), (2.0, -1.0, [1.0, 1.0]), (0.0, 0.0, [0.5, 0.5])]
            {
                let got = place(right * size, up * size);
                let error = (got[0] - ndc[0]).abs().max((got[1] - ndc[1]).abs());
                assert!(error < 1e-6, "{projection:?} {right} {up}: {got:?}");
            }
        }
    }
}
