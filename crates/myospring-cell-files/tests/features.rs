//! What the reader understands and what it refuses, on tiny models.

use myospring_cell_files::{Choices, ReadError, read};
use myospring_core::cell::equations::Equations;

const NOTHING: &dyn Fn(&str) -> Option<String> = &|_| None;

fn of(file: &str, text: &str) -> Result<Equations, ReadError> {
    read(file, text, &Choices::default(), NOTHING)
}

fn rates(equations: &Equations) -> Vec<f64> {
    equations.evaluate(&equations.constant_values(), &equations.start(), 0.0, 0.0).rates()
}

/// A `.mmt` model whose potential, -40 mV, has the rate of an expression.
fn mmt(expression: &str) -> String {
    format!(
        "[[model]]\nf(x, y) = x * y + x\nm.V = -40\n\n[engine]\nt = 0 [s] in [s] bind time\n\n[m]\nuse k.g as h\n\
         dot(V) = {expression}\n    in [mV]\n    two = 2 * inner\n        inner = 1\n    inf = 7\n\n[k]\ng = 3\n"
    )
}

#[test]
fn expressions_of_mmt_have_the_values_of_myokit() {
    // Values by Myokit 1.39.2: `myokit.parse_expression(text).eval()`.
    for (text, value) in [
        ("-2^2", -4.0),
        ("2^3^2", 64.0),
        ("7 // -2", -4.0),
        ("-7 % 3", 2.0),
        ("1 + 2 * 3", 7.0),
        ("if(1 < 2 and not(2 == 3), 5, 6)", 5.0),
        ("piecewise(1 > 2, 1, 2 > 1, 2, 3)", 2.0),
        ("log(8, 2)", 3.0),
        ("(1\n   + 2)", 3.0),
        ("V + 45 [mV]", 5.0),
        ("f(2, 3)", 8.0),
        ("two + inf", 9.0),
        ("h + k.g", 6.0),
    ] {
        let equations = of("a.mmt", &mmt(text)).unwrap_or_else(|error| panic!("{text}: {error}"));
        let [rate] = rates(&equations)[..] else { panic!("one state") };
        assert!((rate * 1000.0 - value).abs() < 1e-12, "{text}: {} is not {value}", rate * 1000.0);
    }
}

#[test]
fn what_is_wrong_in_mmt_is_said_with_line_and_component() {
    for (text, line, words) in [
        (mmt("1 +"), 10, "a value is expected"),
        (mmt("missing"), 10, "there is no variable `missing`"),
        (mmt("sinc(1)"), 10, "there is no function sinc()"),
        (mmt("1 [furlongs]"), 10, "the unit `furlongs` is not known"),
        (
            mmt(&format!("{}1{}", "(".repeat(100_000), ")".repeat(100_000))),
            10,
            "nested more than 200 deep",
        ),
        (mmt("two").replace("inner = 1", "inner = two"), 12, "need each other"),
    ] {
        let error = of("a.mmt", &text).unwrap_err();
        assert!(error.reason.contains(words), "{error}");
        assert_eq!((error.line, error.component.as_deref()), (Some(line), Some("m")), "{error}");
    }
    assert!(of("a.mmt", "nothing").unwrap_err().reason.contains("no model"));
    let none = of("a.mmt", "[[model]]\n[a]\nx = 1\n").unwrap_err();
    assert!(none.reason.contains("no state"), "{none}");
}

#[test]
fn a_function_that_calls_itself_and_one_that_grows_are_refused() {
    let own = mmt("g(1)").replace("f(x, y) = x * y + x", "g(x) = g(x) + g(x)");
    assert!(of("a.mmt", &own).unwrap_err().reason.contains("nested more than"));
    let mut grows = "f0(x) = x + x\n".to_owned();
    for i in 1..40 {
        let inner = format!("f{}(x)", i - 1);
        grows = format!("{grows}f{i}(x) = {inner} + {inner}\n");
    }
    let grows = mmt("f39(1)").replace("f(x, y) = x * y + x\n", &grows);
    assert!(of("a.mmt", &grows).unwrap_err().reason.contains("operations"));
}

#[test]
fn removable_singularities_have_their_limits() {
    for (text, limit) in [
        ("0.1 * (V + 40) / (1 - exp(-(V + 40) / 10))", 1.0),
        ("(V + 40) / (exp((V + 40) / 5) - 1)", 5.0),
        ("2 * (40 + V) * (3 * exp(0.1 * (V + 40)) - 1) / (exp(0.1 * (V + 40)) - 1)", 40.0),
        ("-(V + 40) * 3 / (1 - exp((V + 40) / 4)) / 2", 6.0),
    ] {
        let equations = of("a.mmt", &mmt(text)).unwrap_or_else(|error| panic!("{text}: {error}"));
        let rate = |potential: f64| {
            equations.evaluate(&equations.constant_values(), &[potential], 0.0, 0.0).rates()[0]
                * 1e3
        };
        assert!((rate(-40.0) / limit - 1.0).abs() < 1e-13, "{text}: {}", rate(-40.0));
        for near in [1e-9, 1e-6, 1e-4, 4.9e-3, 5.1e-3, 0.02] {
            let (a, b) = (rate(-40.0 - near), rate(-40.0 + near));
            let middle = f64::midpoint(a, b);
            assert!(
                (middle / limit - 1.0).abs() < 1e-9 + near * near,
                "{text} at {near}: {middle}"
            );
        }
    }
    // No quotient of functions with one zero: left as it is.
    let error = of("a.mmt", &mmt("(V + 39) / (exp(V + 40) - 1)")).unwrap_err();
    assert!(error.reason.contains("not a finite number at the start"), "{error}");
}

/// A CellML model in the form of a version, with potential in V and a current in another component.
fn cellml(version: &str, value: &str) -> String {
    let (public, private, map) = if version == "2.0" {
        ("interface=\"public\"", "interface=\"public\"", false)
    } else {
        ("public_interface=\"out\"", "public_interface=\"in\"", true)
    };
    let connection = if map {
        "<connection><map_components component_1=\"m\" component_2=\"c\"/><map_variables variable_1=\"V\" variable_2=\"V\"/></connection>\
         <connection><map_components component_1=\"e\" component_2=\"m\"/><map_variables variable_1=\"t\" variable_2=\"t\"/></connection>"
    } else {
        "<connection component_1=\"m\" component_2=\"c\"><map_variables variable_1=\"V\" variable_2=\"V\"/></connection>\
         <connection component_1=\"e\" component_2=\"m\"><map_variables variable_1=\"t\" variable_2=\"t\"/></connection>"
    };
    format!(
        "<?xml version=\"1.0\"?>\n<model name=\"a\" xmlns=\"http://www.cellml.org/cellml/{version}#\" xmlns:cellml=\"http://www.cellml.org/cellml/{version}#\">\n\
         <units name=\"mV\"><unit units=\"volt\" prefix=\"milli\"/></units>\n\
         <component name=\"e\"><variable name=\"t\" units=\"second\" {public}/></component>\n\
         <component name=\"m\"><variable name=\"V\" units=\"volt\" initial_value=\"-0.04\" {public}/>\
         <variable name=\"t\" units=\"second\" {private}/>\
         <math xmlns=\"http://www.w3.org/1998/Math/MathML\"><apply><eq/><apply><diff/><bvar><ci>t</ci></bvar><ci>V</ci></apply>\n\
         {value}</apply></math></component>\n\
         <component name=\"c\"><variable name=\"V\" units=\"mV\" {private}/><variable name=\"I\" units=\"mV\"/>\
         <math xmlns=\"http://www.w3.org/1998/Math/MathML\"><apply><eq/><ci>I</ci><apply><times/><cn cellml:units=\"dimensionless\">2</cn><ci>V</ci></apply></apply></math></component>\n\
         {connection}\n</model>\n"
    )
}

#[test]
fn every_version_of_cellml_converts_units_between_components() {
    for version in ["1.0", "1.1", "2.0"] {
        let equations =
            of("a.cellml", &cellml(version, "<apply><minus/><ci>V</ci></apply>")).unwrap();
        assert_eq!(rates(&equations), [0.04e-3], "{version}");
        let values = equations.evaluate(&[], &[-0.04], 0.0, 0.0);
        let current = equations.find("c.I").unwrap();
        assert!((values.variable(current) + 80.0).abs() < 1e-12, "{version}");
        assert_eq!(equations.roles.potential.millivolts.unwrap().1, 1e3);
    }
}

#[test]
fn content_of_mathml_has_its_values() {
    let number = |text: &str| format!("<cn cellml:units=\"dimensionless\">{text}</cn>");
    let (one, two, eight) = (number("1"), number("2"), number("8"));
    for (text, value) in [
        (format!("<apply><root/><degree>{}</degree>{eight}</apply>", number("3")), 2.0),
        (format!("<apply><log/><logbase>{two}</logbase>{eight}</apply>"), 3.0),
        (format!("<apply><log/>{}</apply>", number("100")), 2.0),
        (
            "<cn type=\"e-notation\" cellml:units=\"dimensionless\">1.5<sep/>-3</cn>".to_owned(),
            1.5e-3,
        ),
        ("<pi/>".to_owned(), std::f64::consts::PI),
        (format!("<apply><sec/>{one}</apply>"), 1.0 / 1.0_f64.cos()),
        (format!("<apply><arccot/>{two}</apply>"), 0.5_f64.atan()),
        (format!("<apply><rem/>{}{}</apply>", number("-7"), number("3")), -1.0),
        (
            format!(
                "<piecewise><piece>{one}<apply><lt/>{two}{one}</apply></piece><otherwise>{eight}</otherwise></piecewise>"
            ),
            8.0,
        ),
        (format!("<apply><xor/><true/><false/>{}</apply>", ""), 1.0),
    ] {
        let equations =
            of("a.cellml", &cellml("1.0", &text)).unwrap_or_else(|error| panic!("{text}: {error}"));
        let rate = rates(&equations)[0] * 1000.0;
        assert!((rate - value).abs() < 1e-12, "{text}: {rate}");
    }
}

#[test]
fn what_cannot_be_read_of_cellml_is_said_with_line_and_component() {
    let plain = cellml("1.0", "<ci>V</ci>");
    for (text, words) in [
        (cellml("1.0", "<ci>W</ci>"), "there is no variable `W`"),
        (cellml("1.0", "<apply><int/><ci>V</ci></apply>"), "<int/> cannot be read"),
        (plain.replace("initial_value=\"-0.04\"", ""), "no initial value"),
        (
            plain.replace("<ci>I</ci><apply>", "<cn cellml:units=\"mV\">0</cn><apply>"),
            "left side of an equation",
        ),
        (plain.replace("units=\"volt\" initial", "units=\"vault\" initial"), "`vault`"),
        (plain.replace("<component name=\"c\">", "<component name=\"c\"><reaction/>"), "reactions"),
        (plain.replace("variable_1=\"t\"", "variable_1=\"u\""), "there is no variable `u`"),
        (plain.replace("</model>", "</modell>"), "not valid XML"),
        (plain.replace("<model ", "<!DOCTYPE a [<!ENTITY b \"c\">]><model "), "not valid XML"),
    ] {
        let error = of("a.cellml", &text).unwrap_err();
        assert!(error.reason.contains(words) && error.line.is_some(), "{error}");
    }
    let reset = cellml("2.0", "<ci>V</ci>")
        .replace("<component name=\"c\">", "<component name=\"c\"><reset/>");
    assert!(of("a.cellml", &reset).unwrap_err().reason.contains("resets"));
}

#[test]
fn imports_bring_components_and_stay_in_the_folder() {
    let head = "<model name=\"b\" xmlns=\"http://www.cellml.org/cellml/1.1#\" xmlns:xlink=\"http://www.w3.org/1999/xlink\">";
    let main = |href: &str| {
        format!(
            "{head}<import xlink:href=\"{href}\"><component name=\"m\" component_ref=\"m\"/></import>\
                 <import xlink:href=\"{href}\"><component name=\"e\" component_ref=\"e\"/></import>\
                 <connection><map_components component_1=\"e\" component_2=\"m\"/><map_variables variable_1=\"t\" variable_2=\"t\"/></connection></model>"
        )
    };
    let inner = cellml("1.1", "<apply><minus/><ci>V</ci></apply>");
    let beside = |path: &str| (path == "parts/a.cellml").then(|| inner.clone());
    let equations =
        read("b.cellml", &main("parts/a.cellml"), &Choices::default(), &beside).unwrap();
    assert_eq!(rates(&equations), [0.04e-3]);
    for outside in ["../a.cellml", "/etc/passwd", "http://a.b/c", "file:///a", "parts/../../a"] {
        let error = read("b.cellml", &main(outside), &Choices::default(), &|_| Some(String::new()))
            .unwrap_err();
        assert!(error.reason.contains("folder of the model"), "{error}");
    }
    let itself = |_: &str| Some(main("a.cellml"));
    let error = read("b.cellml", &main("a.cellml"), &Choices::default(), &itself).unwrap_err();
    assert!(error.reason.contains("deep"), "{error}");
}

#[test]
fn one_model_in_both_formats_has_the_same_rates() {
    let text = mmt("-V")
        .replace("[s]", "[ms]")
        .replace("in [mV]", "in [V]")
        .replace("m.V = -40", "m.V = -0.04");
    let (a, b) = (
        of("a.mmt", &text).unwrap(),
        of("a.cellml", &cellml("1.0", "<apply><minus/><ci>V</ci></apply>")).unwrap(),
    );
    assert_eq!(rates(&a)[0], rates(&b)[0] * 1000.0);
}

#[test]
fn a_current_that_depends_on_the_potential_is_no_stimulus() {
    // i_st of sinoatrial cells is the sustained inward current.
    let text = mmt("-i_st")
        .replace("    in [mV]", "    in [mV]\ni_st = 0.5 * V\n    in [A/F]")
        .replace("    two = 2 * inner\n        inner = 1\n    inf = 7\n", "");
    let equations = of("a.mmt", &text).unwrap();
    assert_eq!(equations.roles.stimulus.name, None);
    assert!((rates(&equations)[0] - 0.02).abs() < 1e-15);
}

#[test]
fn damaged_files_are_refused_without_panic() {
    let mut seed = 1_u64;
    let mut random = move |below: usize| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    let pieces: [&[u8]; 12] = [
        b"(", b")", b"[", b"=", b"dot(V)", b"\n ", b"<apply>", b"</", b"1e999", b"use", b"\"\"\"",
        b"\xff",
    ];
    for text in
        [mmt("f(2, V) / (exp(V) - 1)"), cellml("1.0", "<ci>V</ci>"), cellml("2.0", "<ci>V</ci>")]
    {
        for _ in 0..1500 {
            let mut bytes = text.clone().into_bytes();
            for _ in 0..=random(4) {
                let at = random(bytes.len());
                match random(3) {
                    0 => bytes[at] = random(128) as u8,
                    1 => drop(bytes.drain(at..(at + random(20)).min(bytes.len()))),
                    _ => drop(bytes.splice(at..at, pieces[random(12)].iter().copied())),
                }
            }
            let _ = of("a", &String::from_utf8_lossy(&bytes));
        }
    }
}
