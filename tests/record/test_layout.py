"""docs/reference/record.md lists what the table of the record has, word for word.

``python -m tests.record.test_layout`` prints the list.
"""

from __future__ import annotations

from pathlib import Path
from typing import get_type_hints

from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW
from physim.record import Record
from tests.helpers import inside
from tests.helpers.records import make_record

Attributes, AttributesModel, TABLE = inside(
    "physim.record", "Attributes", "AttributesModel", "TABLE"
)
PAGE = Path(__file__).parents[2] / "docs/reference/record.md"


def listed() -> str:
    """The table of attributes, that of datasets, and the columns of each table."""
    lines = ["| attribute | `Record` has it as | what |", "|---|---|---|"]
    for name, hint in get_type_hints(Attributes, include_extras=True).items():
        key = AttributesModel.model_fields[name].alias or name
        lines.append(f"| `{key}` | `{name}` | {hint.__metadata__[-1]} |")
    lines += ["", "| dataset | shape | unit | `Record` has it as | what |", "|---|---|---|---|---|"]
    for one in TABLE.values():
        shape = f"({', '.join(one.shape)})"
        lines.append(f"| `{one.path}` | {shape} | {one.unit} | `{one.name}` | {one.words} |")
    for one in TABLE.values():
        if one.fields[0].name:
            lines += ["", f"| column of `{one.path}` | unit | what |", "|---|---|---|"]
            lines += [f"| `{f.name}` | {f.unit} | {f.words} |" for f in one.fields]
    return "\n".join(lines) + "\n"


def test_the_page_lists_all_that_a_record_has() -> None:
    assert listed() in PAGE.read_text(encoding="utf-8")


def test_contacts_are_kept_as_the_engine_gives_them() -> None:
    assert Record.contacts.dtype == CONTACT_ROW
    assert Record.false_contacts.dtype == FALSE_CONTACT_ROW


def test_every_dataset_and_attribute_is_a_property() -> None:
    with make_record(seconds=0.1) as record:
        for one in TABLE.values():
            rows = getattr(record, one.name)
            if getattr(Record, one.name) is one:
                assert rows.tobytes() == record.read(one.path).tobytes()
                assert one.words in one.__doc__
        for name in AttributesModel.model_fields:
            assert getattr(record, name) is not None


if __name__ == "__main__":
    print(listed(), end="")
