use myospring::integrate::quasi_static::Tolerance;
use myospring::mechanics::material;
use myospring::mesh::{built_in, profile::Profile, thick};
use myospring::simulation::Simulation;
use myospring_core as myospring;
use std::sync::Arc;
use std::time::Instant;
fn main() {
    let a: Vec<f64> = std::env::args().skip(1).map(|x| x.parse().unwrap()).collect();
    for profile in [Profile::Round, Profile::Dome, Profile::Slab] {
        let form = thick::Form { profile, thickness: 10.0 };
        let t = Instant::now();
        let (mesh, thick, report) =
            thick::from_outline(&built_in::adult_ventricular(), form, a.first().copied()).unwrap();
        println!("{report}\n mesh {:.3} s", t.elapsed().as_secs_f64());
        let mut s = Simulation::new(mesh);
        s.thick = Some(Arc::new(thick));
        s.material = material::of_thick_cell(material::default_material());
        s.peak_tension = a.get(1).copied().unwrap_or(50.0);
        s.helix_angle = a.get(2).copied().unwrap_or(0.0).to_radians();
        let t = Instant::now();
        let out = s.run_quasi_static(Tolerance::default(), |_| true).unwrap();
        println!("beat {:.3} s {:?} stop {:?}", t.elapsed().as_secs_f64(), out.effort, out.stop);
        let peak = out
            .recording
            .samples
            .iter()
            .enumerate()
            .max_by(|a, b| a.1.shortening_pct.total_cmp(&b.1.shortening_pct))
            .unwrap();
        println!(
            "{:.4} % width {} area {}",
            peak.1.shortening_pct,
            peak.1.width_um / out.recording.samples[0].width_um,
            peak.1.area_um2 / out.recording.samples[0].area_um2
        );
        for s in &out.recording.signals {
            println!("{} {} -> {}", s.name, s.values[0], s.values[peak.0] / s.values[0]);
        }
    }
}
