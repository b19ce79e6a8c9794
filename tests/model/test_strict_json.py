"""JSON from outside: what Python's reader takes beyond the standard is refused."""

import pytest

from explicable.model.strict_json import parse_json


@pytest.mark.parametrize("text", ['{"a": NaN}', "[-Infinity]", '{"b": {"a": 1, "a": 2}}', '"\\ud800"'])
def test_what_is_no_json_is_refused(text):
    with pytest.raises(ValueError, match=r"no JSON number|occurs twice|surrogates"):
        parse_json(text)


def test_json_is_read():
    assert parse_json('{"a": [1, 2.5, "\\ud83d\\ude00", null, true]}') == {
        "a": [1, 2.5, "\N{GRINNING FACE}", None, True]
    }
