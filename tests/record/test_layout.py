"""The table of the record, from which the site's page is made, is what a record has."""

from __future__ import annotations

import h5py

from physim.contacts import CONTACT_ROW, FALSE_CONTACT_ROW
from physim.record import Record
from tests.helpers import inside
from tests.helpers.records import make_record

AttributesModel, TABLE = inside("physim.record", "AttributesModel", "TABLE")


def test_contacts_are_kept_as_the_engine_gives_them() -> None:
    assert Record.contacts.dtype == CONTACT_ROW
    assert Record.false_contacts.dtype == FALSE_CONTACT_ROW


def test_every_dataset_and_attribute_is_a_property(tmp_path) -> None:
    with make_record(seconds=0.1, sensed=True) as record:
        for one in TABLE.values():
            rows = getattr(record, one.name)
            if getattr(Record, one.name) is one:
                assert rows.tobytes() == record.read(one.path).tobytes()
                assert one.words in one.__doc__
        for name in AttributesModel.model_fields:
            assert (getattr(record, name) is None) == (name == "judged")
        record.save(tmp_path / "record.h5")
    with h5py.File(tmp_path / "record.h5") as file:
        paths: list[str] = []
        file.visititems(
            lambda name, one: paths.append(f"/{name}") if hasattr(one, "dtype") else None
        )
        assert set(paths) == set(TABLE) - {"/steps/steering"}
        fields = AttributesModel.model_fields.items()
        keys = {field.alias or name for name, field in fields if field.is_required()}
        assert set(file.attrs) == keys  # the others are of a branch or a log alone
