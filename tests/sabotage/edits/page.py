"""Edits of `physim.drawing.page`; its scripts are tried in `tests.browser`."""

from __future__ import annotations

from tests.sabotage.edit import Edit

DATA, WHY, PAGE = (f"tests/page/test_{name}.py" for name in ("data", "why", "page"))
ROOM = "physim/drawing/page"

EDITS = (
    Edit(
        "page",
        "physim/drawing/page/decisions.py",
        "_on_its_side",
        "np.where(is_below, -quantum, quantum)",
        "np.where(is_below, 0.0, 0.0)",
        "what a robot saw stays on its side of a threshold",
        "tests/page/test_data.py::test_what_is_below_a_threshold_stays_so",
    ),
    Edit(
        "page",
        "physim/drawing/page/decisions.py",
        "pack_decisions",
        "values = _on_its_side(values, fine, below, bound)",
        "values = values",
        "the page says which threshold was passed",
        "tests/page/test_data.py::test_the_page_keeps_values_on_their_side_of_the_thresholds",
    ),
    Edit(
        "page",
        "physim/drawing/page/curves.py",
        "_pack_errors",
        "curves.values[at].T",
        "curves.values[at]",
        "errors of a page are those of its robots, one after the other",
        f"{DATA}::test_errors_are_those_of_samples_whoever_decided",
    ),
    Edit(
        "page",
        "physim/analysis/metrics/registry.py",
        "_deepest_contact",
        "deepest.depth_step * run.record.dt",
        "deepest.time",
        "the deepest contact is looked at where it is deepest",
        "tests/page/test_page.py::test_the_deepest_contact_is_looked_at_where_it_is_deepest",
    ),
    Edit(
        "page",
        "physim/drawing/distances.py",
        "Distances.__init__",
        "if record.record_every > 1:",
        "if False:",
        "distances of now of a record with few samples are those of its poses",
        "tests/page/test_data.py::test_distances_of_now_of_few_samples_are_those_of_the_poses",
    ),
    Edit(
        "page",
        "physim/drawing/page/events.py",
        "stands",
        "int(np.searchsorted(steps, record.arrived[robot]))",
        "int(record.arrived[robot])",
        "arrival is a step, of which not every one is a sample",
        "tests/page/test_events.py::test_who_arrived_between_two_samples_stood_until_the_next",
    ),
    Edit(
        "page", f"{ROOM}/packing.py", "_planes",
        "(numbers << 1) ^ (numbers >> 63)", "(numbers << 1)",
        "negative numbers come back", f"{DATA}::test_numbers_come_back",
    ),
    Edit(
        "page", f"{ROOM}/packing.py", "Pack.whole",
        "if len(numbers) and int(np.abs(numbers).max()) >= LARGEST",
        "if len(numbers) and int(np.abs(numbers).max()) >= 4 * LARGEST",
        "a number that does not fit is refused",
        f"{DATA}::test_a_number_that_does_not_fit_is_refused",
    ),
    Edit(
        "page", f"{ROOM}/packing.py", "Pack.whole",
        "if far and len(numbers)", "if False and len(numbers)",
        "places far from the origin keep their digits",
        f"{DATA}::test_a_run_far_from_the_origin_is_shown_as_well",
    ),
    Edit(
        "page", f"{ROOM}/data.py", "_check_room",
        "apart >= MOST_APART", "False",
        "robots too far apart are refused in a line",
        f"{DATA}::test_robots_too_far_apart_are_refused_in_a_line",
    ),
    Edit(
        "page", f"{ROOM}/data.py", "_check_room",
        "turned >= MOST_TURNED", "False",
        "headings too far apart are refused in a line",
        f"{DATA}::test_robots_too_far_apart_are_refused_in_a_line",
    ),
    Edit(
        "page", f"{ROOM}/events.py", "stands",
        "end if record.arrived[robot] < 0 else min(int(end), arrived)", "end",
        "a robot that has arrived no longer counts as standing",
        "tests/page/test_events.py::test_what_counts_as_standing",
    ),
    Edit(
        "page", f"{ROOM}/findings.py", "_findings",
        "yield from _contacts(found, summary)", "",
        "every contact of a validation leads to its moment",
        "tests/page/test_findings.py::test_contacts_and_disagreements_are_all_told",
    ),
    Edit(
        "page", f"{ROOM}/knots.py", "_knots_of",
        "error += reach *", "error += 0.0 *",
        "a turn of a robot counts, too",
        f"{DATA}::test_knots_keep_every_sample_within_the_tolerance",
    ),
    Edit(
        "page", f"{ROOM}/knots.py", "between",
        "np.where(is_arc, half * (share - 1.0), 0.0)", "np.where(is_arc, 0.0 * share, 0.0)",
        "between knots robots are on an arc", f"{DATA}::test_one_command_needs_two_knots",
    ),
    Edit(
        "page", f"{ROOM}/decisions.py", "_pack_others",
        "changed.append(now != before)", "changed.append(before is None)",
        "considered robots are those of each decision",
        f"{DATA}::test_decisions_and_contacts_come_back",
    ),
    Edit(
        "page", f"{ROOM}/curves.py", "_least",
        "np.argmin(least[low:high])", "np.argmax(least[low:high])",
        "bins keep the shortest distance", f"{DATA}::test_bins_keep_the_shortest_distance",
    ),
    Edit(
        "page", f"{ROOM}/why.py", "_settings",
        "dict(part.settings) if made is None else dict(made.model_dump())", "dict(part.settings)",
        "thresholds that the world does not give are the defaults",
        f"{WHY}::test_thresholds_are_the_settings_in_force",
    ),
    Edit(
        "page", f"{ROOM}/document.py", "_json",
        '.replace("<", "\\\\u003c")', "",
        "no name ends the element that holds it",
        f"{PAGE}::test_no_name_ends_the_element_that_holds_it",
    ),
    Edit(
        "page", f"{ROOM}/document.py", "Page._repr_html_",
        'sandbox="allow-scripts"', "",
        "a page in a notebook reaches nothing outside of it",
        f"{PAGE}::test_a_notebook_shows_the_page_in_a_frame_of_its_own",
    ),
    Edit(
        "page", f"{ROOM}/moments.py", "_who",
        "return min(robots", "return max(robots",
        "of two robots the one behind is asked why",
        f"{PAGE}::test_of_two_robots_the_one_behind_is_asked_why",
    ),
    Edit(
        "page", "physim/escaping.py", "html_text",
        "as_entities(escaped(text))", "escaped(text)",
        "in HTML a name is only a name",
        "tests/page/test_notebook.py::test_a_notebook_shows_a_small_table",
    ),
    Edit(
        "page",
        "physim/drafts.py",
        "discard",
        "suppress(OSError)",
        "suppress(KeyError)",
        "an error of writing is told, not one of clearing up",
        "tests/page/test_page.py::test_of_a_page_that_cannot_be_written_nothing_is_left",
    ),
    Edit(
        "page", f"{ROOM}/why.py", "_settings",
        "except ValidationError:\n        return {}", "except ValidationError:\n        made = None",
        "of settings that a controller refuses nothing is told",
        f"{WHY}::test_of_settings_that_are_refused_nothing_is_told",
    ),
    Edit(
        "page", "physim/drawing/page/document.py", "page",
        "not validation.is_of(records[0])", "False",
        "a page tells of its own run alone",
        "tests/page/test_findings.py::test_a_validation_is_of_the_run_that_is_shown",
    ),
    Edit(
        "page",
        "physim/drawing/page/why.py",
        "_thresholds",
        "own.get(column, {})",
        "{}",
        "the page knows the threshold of boundaries ahead",
        "tests/page/test_why.py::test_thresholds_are_the_settings_in_force",
    ),
)  # fmt: skip
