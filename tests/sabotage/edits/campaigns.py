"""Edits of `physim.campaigns`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

EDITS = (
    Edit(
        "campaigns",
        "physim/campaigns/runner.py",
        "do_all",
        "waiting.extendleft(reversed(list(follow(key, done))))",
        "pass",
        "jobs that follow are done",
        "tests/campaigns/test_runner.py::test_jobs_that_follow",
    ),
    Edit(
        "campaigns",
        "physim/campaigns/runner.py",
        "do_all",
        "raise error",
        "pass",
        "a fault of the program ends the work",
        "tests/campaigns/test_runner.py::test_a_fault_of_the_program_tells_where",
    ),
    Edit(
        "campaigns",
        "physim/campaigns/processes.py",
        "_limited",
        "signal.setitimer(signal.ITIMER_REAL, seconds)",
        "pass",
        "a process that holds the interpreter ends at its limit",
        "tests/campaigns/test_sweep.py::test_the_timer_of_the_system_ends_what_nobody_watches",
    ),
    Edit(
        "campaigns",
        "physim/campaigns/rows.py",
        "Shards._merge",
        "file.unlink()",
        "pass",
        "many rows are few files",
        "tests/campaigns/test_rows.py::test_many_rows_are_few_files_and_each_is_there_once",
    ),
    Edit(
        "campaigns",
        "physim/campaigns/rows.py",
        "_better",
        "other.failed and not one.failed",
        "False",
        "a run that came to its end stands",
        "tests/campaigns/test_rows.py::test_what_came_to_its_end_stands_whatever_was_written_later",
    ),
    Edit(
        "campaigns",
        "physim/campaigns/spec.py",
        "RunSpec.key",
        "self.source_hash, ",
        "",
        "another source of the controller is another run",
        "tests/campaigns/test_spec.py::test_what_makes_another_run",
    ),
    Edit(
        "campaigns",
        "physim/campaigns/sweep.py",
        "_Sweep._count",
        "self.have.add(row.run)",
        "pass",
        "what has a row is not run again",
        "tests/campaigns/test_sweep.py::test_what_has_a_row_is_not_run_again",
    ),
    Edit(
        "campaigns",
        "physim/campaigns/folder.py",
        "_check",
        "there.keys() >= wanted.keys() or there.keys() <= wanted.keys()",
        "True",
        "the folder of another campaign is refused",
        "tests/campaigns/test_sweep.py::test_the_folder_of_another_campaign_is_refused",
    ),
)
