"""Files that appear whole or not at all."""

import os
import threading

import pytest

from explicable.model.files import write_whole


def test_a_file_is_replaced_and_nothing_is_left_beside_it(tmp_path):
    for content in ("one", b"two"):
        write_whole(tmp_path / "new" / "file", content)
    assert [(path.name, path.read_text()) for path in (tmp_path / "new").iterdir()] == [("file", "two")]


def test_a_name_may_be_as_long_as_the_file_system_allows(tmp_path):
    name = "\N{GREEK SMALL LETTER ALPHA}" * 125 + ".plan"
    write_whole(tmp_path / name, "text")
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_a_symbolic_link_stays_and_its_target_is_written(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "link").symlink_to("there/file")
    for content in ("made", "replaced"):
        write_whole(tmp_path / "link", content)
        assert (tmp_path / "link").is_symlink()
        assert (tmp_path / "there" / "file").read_text() == content


def test_what_is_no_file_is_written_to_and_not_replaced(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    read: list[str] = []
    reader = threading.Thread(target=lambda: read.append(pipe.read_text()), daemon=True)
    reader.start()
    write_whole(pipe, "through the pipe")
    reader.join(timeout=300)
    assert read == ["through the pipe"]
    assert pipe.is_fifo()


@pytest.mark.parametrize("name", ["n" * 300, "file/below", "folder"])
def test_an_error_names_the_file_that_was_asked_for(tmp_path, name):
    (tmp_path / "file").write_text("as it was")
    (tmp_path / "folder").mkdir()
    with pytest.raises(OSError) as raised:  # noqa: PT011 (which one depends on the system)
        write_whole(tmp_path / name, "text")
    assert raised.value.filename == str(tmp_path / name)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder"]
    assert (tmp_path / "file").read_text() == "as it was"
