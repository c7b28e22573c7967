"""``physim league``: controllers beside one another in many worlds."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Annotated

from physim.cli.options import File, Out, Output, Seeds, Words, Workers, kind, whole
from physim.cli.pictures import files_written
from physim.cli.progress import Bar
from physim.errors import PhysimError, plural
from physim.files import write_text
from physim.json_text import json_text
from physim.terminal import INTERRUPTED, interrupts

Films = Annotated[int, kind(whole(0, 100))]


def league(
    *,
    controllers: Words = (),
    worlds: Words = (),
    seeds: Seeds | None = None,
    programme: File | None = None,
    output: Output = Path('league'),
    workers: Workers | None = None,
    films: Films = 6,
    no_video: bool = False,
    no_run: bool = False,
    retry: bool = False,
    json: bool = False,
    quiet: bool = False,
    out: Out,
) -> int:  # fmt: skip
    """Let controllers drive in the same worlds, on the same seeds, and tell which is safe, which
    gets through, and what that costs. Each entrant, a controller with settings, takes the place of
    the world's own controller. DIR keeps what ran: repeat the command to continue after an
    interruption, or with other controllers, worlds or seeds to add runs. A controller of your own
    is placed among those that are in DIR.

    options:
      --controllers NAME,...  only these: entrants of the programme, registered controllers (physim
          list), or your own as module:Class (default: all of the programme)
      --worlds WORLD,...  only these worlds, shipped ones or files (default: all of the programme)
      --seeds A:B  seeds A to B - 1 (default: those of the programme)
      --programme FILE  entrants, worlds and seeds (default: those of DIR, else the shipped ones)
      -o, --output DIR  folder (league)
      --workers N  processes (as many as cores, at most 8)
      --films N  how many films to make of best and worst runs (6)
      --no-video  make no films
      --no-run  make the pages from the runs that are in DIR
      --retry  run again the runs that crashed: by an error, at their limit, or killed
      --json  print all figures as JSON instead
      --quiet  print no progress and no result

    written to DIR:
      LEAGUE.md            verdict and ranking, a table for each kind of world, then every world
      league.html          the same with films, which lie beside it in videos/
      results.csv, ...     the runs, as physim sweep writes them (for physim compare, physim replay)
      league.json          entrants and worlds, and which world refuses whom

    exit codes:
      0    all runs have a row, whatever the results
      2    bad input; nothing that was written is lost
      130  interrupted (Ctrl-C, SIGTERM): finished runs are kept; the same command continues

    examples:
      physim league
      physim league --controllers mode_switching,path_following --seeds 0:5 -o small
      physim league -o league --controllers mine:Mine
      physim league -o league --no-run --no-video
    """
    from physim.campaigns.cluster import executor
    from physim.campaigns.folder import Folder, read
    from physim.campaigns.league import (
        cells_of,
        chosen,
        joined,
        placed,
        read_league,
        read_programme,
        write_league,
    )
    from physim.campaigns.outcomes import Outcomes
    from physim.campaigns.report.league import standings, standings_values
    from physim.campaigns.report.league_page import (
        MARKDOWN,
        PAGE,
        films_of,
        league_text,
        pages,
        said,
    )
    from physim.campaigns.sweep import sweep

    before = read_league(output)
    interrupted = False
    with interrupts() as interrupt:
        if no_run:
            if before is None:
                raise PhysimError(f"{output}: holds no league; without --no-run it is made")
            whole_league = before
        else:
            source = read_programme(programme) if programme or not before else before
            entrants = chosen(source, controllers)
            now = placed(source, worlds).model_copy(update={"entrants": entrants})
            if seeds is not None:
                now = now.model_copy(update={"seeds": [seeds.start, seeds.stop]})
            grid, refused = cells_of(entrants, now.worlds, range(*now.seeds))
            whole_league = joined(before, now, refused)
            Folder(output)  # refuses links and pipes
            write_league(output, whole_league)
            with Bar("league", len(grid), "runs", quiet) as bar, executor(workers, None) as team:
                tally = sweep(
                    grid, output, team, retry=retry, stop=interrupt, beside=True,
                    progress=lambda now: bar.count(now.known, now.asked, now.note),
                )  # fmt: skip
            interrupted = tally.interrupted
            if interrupted:
                print(
                    f"interrupted: {tally.known:,} of {plural(tally.asked, 'run')} done; the same "
                    f"command goes on ({output})", file=sys.stderr,
                )  # fmt: skip
        found = standings(whole_league, Outcomes(read(output)), Folder(output).asked())
        most = 0 if no_video or interrupted else films
        with Bar("films", most, "films", quiet) as bar:
            shown = films_of(found, output, most, controllers, bar.count, interrupt)
        for name, text in pages(found, output, shown, "physim league").items():
            write_text(output / name, text)
    if json:
        print(json_text(standings_values(found) | {"said": said(found)}), end="", file=out)
    elif not quiet:
        print(league_text(found), end="")
        print(files_written(output, (MARKDOWN, PAGE)))
    return INTERRUPTED if interrupted else 0
