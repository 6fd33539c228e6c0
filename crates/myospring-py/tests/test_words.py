"""Messages name the arguments of Python, not the options of the program."""

import re
from pathlib import Path

import pytest
from myospring import _native

CRATES = Path(__file__).parents[2]
LIBRARY = ("myospring", "myospring-core", "myospring-microscopy", "myospring-output")


@pytest.mark.parametrize(
    ("said", "in_python"),
    [
        ('give the side of one, like --pixel-size "0.27 um" (the', "give the side of one, like pixel_size_um=0.27 (the"),
        ("cell 1 was taken (--cell N or --seed X,Y takes another)", "cell 1 was taken (cell or seed takes another)"),
        ("`myospring track --cell all` follows each", '`track(..., cell="all")` follows each'),
        ("the frame cuts it; --allow-cut includes it", "the frame cuts it; allow_cut=True includes it"),
        ("refused; --any-size takes it", "refused; any_size=True takes it"),
        ("(--min-area, --max-area)", "(min_area_um2, max_area_um2)"),
        ("; `--model land_2017` does not.", '; `model="land_2017"` does not.'),
        ("or --integrator quasi-static, or", 'or integrator="quasi-static", or'),
        ("give the frame rate (--frame-rate 250), in", "give the frame rate (frame_rate_per_s=250), in"),
        ('--time-unit us or --time-unit "0.01 ms"', 'time_unit="us" or time_unit="0.01 ms"'),
        ("(--kind says what a column is)", "(kind says what a column is)"),
        ("(--unit % if not)", '(unit="%" if not)'),
        ("its unit is um, and --unit says nm", "its unit is um, and unit says nm"),
        ("(--skip-gaps)", "(skip_gaps=True)"),
        ("is a curve (--layout columns if not)", "is a curve (give arrays if not)"),
        ("`shape.pixel_size` = 0", "`pixel_size_um` = 0"),
        ("a range -- as this -- stays, and a--b", "a range -- as this -- stays, and a--b"),
    ],
)
def test_an_option_of_the_program_is_said_as_an_argument(said: str, in_python: str) -> None:
    assert _native.in_python(said) == in_python


def test_no_message_of_the_library_names_an_option_in_python() -> None:
    literal = re.compile(r'"(?:[^"\\]|\\.)*"', re.DOTALL)
    option = re.compile(r"(?<![\w-])--[a-z]")
    told = []
    for crate in LIBRARY:
        for file in sorted((CRATES / crate / "src").rglob("*.rs")):
            code = "\n".join(line for line in file.read_text().splitlines() if not line.strip().startswith("//"))
            texts = (text.strip('"').replace('\\"', '"') for text in literal.findall(code))
            # An option's own name is in the table of settings, and what names the program means the program.
            told += [text for text in texts if option.search(text) and " " in text and "`myospring " not in text]
    assert len(told) > 20
    assert [text for text in told if option.search(_native.in_python(text))] == []
