fn main() {
    for f in std::env::args().skip(1) {
        let spine = tubecert::Spine::from_json_str(&std::fs::read_to_string(&f).unwrap()).unwrap();
        let o = tubecert::RadiusOptions::new().all_terms(std::env::var("ALL").is_ok());
        let t = std::time::Instant::now();
        let r = tubecert::radius(&spine, &o).unwrap();
        println!(
            "{f} {:?} {:?} also {:?} {} cells {} {:?}\n   {:?}\n   {:?} {:?}",
            r.delta,
            r.limited_by,
            r.also,
            r.complete,
            r.cells,
            t.elapsed(),
            r.terms,
            r.at,
            r.rim
        );
    }
}
