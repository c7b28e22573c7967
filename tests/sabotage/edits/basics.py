"""Edits of what stands below all rooms: compiling, errors, randomness."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "basics",
        "physim/randomness.py",
        "stream",
        "[seed, purpose_key(purpose), robot]",
        "[seed, purpose_key(purpose)]",
        "each robot has a random stream of its own",
        "tests/test_randomness.py::test_headings_depend_on_seed_purpose_and_robot_alone",
    ),
    Edit(
        "basics",
        "physim/randomness.py",
        "stream",
        "[seed, purpose_key(purpose), robot]",
        "[seed, robot]",
        "each purpose has a random stream of its own",
        "tests/test_randomness.py::test_streams_differ_by_each_part_of_their_key_and_stay_what_they_are",
    ),
    Edit(
        "basics",
        "physim/compiled.py",
        "_keep_in_temporary_folder",
        "and not found.st_mode & 0o077",
        "",
        "code is run from a folder that is the user's alone",
        "tests/test_compiled.py::"
        "test_kernels_run_without_a_cache_where_the_temporary_folder_is_not_the_users",
    ),
    Edit(
        "basics",
        "physim/compiled.py",
        "source_stamp",
        'hasher.update(f"{file.name}\\0".encode() + file.read_bytes())',
        'hasher.update(f"{file.name}\\0".encode())',
        "an edit of a source compiles anew",
        "tests/test_compiled.py::test_the_stamp_changes_with_any_source",
    ),
    Edit(
        "basics",
        "physim/compiled.py",
        "_dispatcher",
        '{"error_model": "numpy", "no_cfunc_wrapper": True, **options}',
        '{"error_model": "numpy", "no_cfunc_wrapper": True, "fastmath": True, **options}',
        "kernels compute by the standard: no liberties with NaN and infinity",
        "tests/test_compiled.py::test_kernels_know_what_is_no_number_and_what_is_infinite",
    ),
    Edit(
        "basics",
        "physim/linking.py",
        "WholeLibrary.finalize",
        'function.linkage = "private"',
        'function.linkage = "internal"',
        "a piece is not taken for the whole of the same name",
        "tests/test_compiled.py::test_a_kernel_may_be_called_before_and_after_another_that_contains_it",
    ),
    Edit(
        "basics",
        "physim/linking.py",
        "only_borrows",
        "return not is_counted(state.return_type) and all(map(counts_nothing, statements))",
        "return False",
        "a kernel that only looks at arrays counts no references",
        "tests/test_compiled.py::test_references_are_counted_where_arrays_are_made_and_only_there",
    ),
    Edit(
        "basics",
        "physim/linking.py",
        "only_borrows",
        "not is_counted(state.return_type) and",
        "",
        "a kernel that returns an array counts references",
        "tests/test_compiled.py::test_references_are_counted_where_arrays_are_made_and_only_there",
    ),
    Edit(
        "basics",
        "physim/linking.py",
        "only_borrows",
        'return value.op != "getitem" or not is_counted(typed[value.index.name])',
        "return True",
        "a kernel that copies picked rows counts references",
        "tests/test_compiled.py::test_references_are_counted_where_arrays_are_made_and_only_there",
    ),
    Edit(
        "basics",
        "physim/linking.py",
        "only_borrows",
        "return isinstance(typed[value.func.name], types.NamedTupleClass)",
        "return True",
        "a kernel that makes an array for itself counts references",
        "tests/test_compiled.py::test_references_are_counted_where_arrays_are_made_and_only_there",
    ),
)
