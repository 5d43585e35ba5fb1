//! The catalogue of hard cases: one test for each, named by its letter and number. Where a usual
//! technique fails, a copy of it is kept here and shown to fail.

#[path = "../common/mod.rs"]
mod common;
#[path = "../gltf_fixture/mod.rs"]
mod gltf_fixture;

mod a_arithmetic;
mod b_triangles;
mod c_boxes;
mod closed_mesh;
mod d_spheres;
mod e_spawned_rays;
mod f_lights;
mod g_bsdfs;
mod h_integrator;
mod i_random;
mod j_accumulation;
mod k_camera;
mod l_determinism;
mod l_first_hits;
mod planted_defects;
mod probe;
mod traced;
