import numpy as np
import pytest

from explicable.errors import InputError, UsageError
from explicable.execution.participants import Participant, builtin_families, parse_families, read_families


def test_built_in_families_draw_different_participants_by_the_seed():
    for family in builtin_families().values():
        first, again, other = (family.draw(1, np.random.default_rng(seed)) for seed in (0, 0, 1))
        assert first == again != other
        assert first.name == f"simulated-{family.name}-1"


def test_drawn_parameters_stay_in_their_ranges():
    family = parse_families("[calm]\nslack = [1, 3]\nnoise = 0.1")["calm"]
    drawn = [family.draw(n, np.random.default_rng(n)) for n in range(50)]
    assert all(1 <= participant.slack <= 3 and participant.noise == 0.1 for participant in drawn)


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("noise", "not TOML"),
        ("", "no family"),
        ("slack = 1", "expected a table"),
        ("[a]\nslack = -1", "slack must be a cost of at least 0"),
        ("[a]\nslack = inf", "slack must be a cost"),
        ("[a]\ntemperature = 0", "temperature must be a cost"),
        ("[a]\nnoise = 1.5", "noise must be a probability"),
        ("[a]\nnoise = nan", "noise must be a probability"),
        ("[a]\nnoise = true", "noise must be a probability"),
        ("[a]\nnoise = [0.2, 0.1]", "noise must be a single value or a range"),
        ("[a]\nnoise = []", "noise must be a single value or a range"),
        ("[a]\nhorizon = 'tomorrow'", "horizon must be one of request, mission"),
        ("[a]\nhorizon = ['request', 'mission']", "horizon must be a single value"),
        ("[a]\ninitiative = 1", "initiative must be true or false"),
        ("[a]\npatience = 1", "unknown parameter 'patience'"),
    ],
)
def test_faulty_families_are_refused_with_their_place(text, complaint):
    with pytest.raises(InputError, match=rf"^families\.toml: .*{complaint}"):
        parse_families(text, "families.toml")


def test_a_file_that_is_not_text_is_refused(tmp_path):
    (tmp_path / "families.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="UTF-8"):
        read_families(tmp_path / "families.toml")


def test_parameters_out_of_range_are_misuse():
    with pytest.raises(UsageError, match="memory"):
        Participant("simulated-1", memory=2.0)
