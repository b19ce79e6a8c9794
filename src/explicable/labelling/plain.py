"""The plain text format of sequence labelling toolkits, for use with the conditional random field itself."""

from pathlib import Path

from explicable.errors import TraceError

UNOBSERVED = "?"


def read_feature_sequences(
    path: str | Path,
) -> tuple[list[list[tuple[str, ...]]], list[list[str | None]]]:
    r"""Read sequences of features: one step a line, its label last; a blank line ends a sequence.

    Words are separated by blanks or tabs. The label ``?`` says that nobody was asked.

    Returns
    -------
    features, labels
        Of each step of each sequence, ready for `ConditionalRandomField.fit`.

    Raises
    ------
    TraceError
        If the file is not UTF-8.

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     _ = (Path(folder) / "steps.txt").write_text("move near yes\nmove far no\n\nvisit ?\n")
    ...     read_feature_sequences(Path(folder) / "steps.txt")
    ([[('move', 'near'), ('move', 'far')], [('visit',)]], [['yes', 'no'], [None]])
    """
    try:
        text = Path(path).read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise TraceError(f"not a text file in UTF-8 ({error.reason})", path=path) from error
    features: list[list[tuple[str, ...]]] = []
    labels: list[list[str | None]] = []
    in_sequence = False
    for line in text.split("\n"):
        words = line.split()
        if words and not in_sequence:
            features.append([])
            labels.append([])
        in_sequence = bool(words)
        if words:
            features[-1].append(tuple(words[:-1]))
            labels[-1].append(None if words[-1] == UNOBSERVED else words[-1])
    return features, labels
