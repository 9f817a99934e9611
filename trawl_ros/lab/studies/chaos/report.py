"""Report of the fault injection."""

from pathlib import Path

from matplotlib.figure import Figure

from trawl_ros.lab.report.measured import MeasuredValue
from trawl_ros.lab.report.page import Page, write_page
from trawl_ros.lab.running.chain import CHAIN
from trawl_ros.lab.studies.chaos.plan import IDENTIFICATION
from trawl_ros.lab.studies.chaos.rows import MOST_LOST_S, chaos_sections
from trawl_ros.lab.studies.chaos.study import Chaos
from trawl_ros.lab.studies.soak.rows import series
from trawl_ros.report.pictures import Drawing

REPORT = 'chaos.md'


def write_chaos(folder: Path, chaos: Chaos) -> list[MeasuredValue]:
    """Write ``chaos.json``, ``.md``, ``.html`` and ``.png`` into a folder; return the rows."""
    plan = chaos.plan
    page = Page(
        name='chaos',
        title='Chaos in the graph',
        command=f'trawl study chaos --hours {plan.hours:g} --kills {plan.kills} '
        f'--seed {plan.seed} --gear {plan.gear}',
        method=(
            'The chain and `identification_node`, each a process of its own, tow steady states as '
            f'fast as they go ({plan.hours:g} h at sea, a net of 12 meshes around), once '
            f'undisturbed and once with faults in a random order (seed {plan.seed}): nodes are '
            'stopped (SIGSTOP) for some seconds and go on, are killed (SIGKILL) and started '
            'anew; a second publisher gives readings 15 % too large; a flood repeats a message '
            '1000 times a second; `/clock` is set off by another source; stamps are the latest '
            'there can be; progress is told that never gets on. The disk of the recorder is full: '
            'a limit of the process (RLIMIT_FSIZE), which fails the same way. The simulation is '
            'stopped, but not killed: it is the sea. Then the recorder alone is killed '
            f'{plan.kills} times while all topics come as fast as the simulation goes, with truth '
            'ten times a second.'
        ),
    )
    caption = (
        'Resident memory on the tow with faults (grey lines), and what each recorder that was '
        'killed at full load had lost.'
    )
    return write_page(
        folder, page, chaos_sections(chaos), [Drawing('chaos', caption, _figure(chaos))]
    )


def _figure(chaos: Chaos) -> Figure:
    figure = Figure(figsize=(8.0, 6.5), layout='constrained')
    memory, lost = figure.subplots(2, 1)
    for fault in chaos.wild.done:
        memory.axvline(fault.at_s / 3600.0, color='0.85', linewidth=0.8, zorder=0)
    for number, node in enumerate((*CHAIN, IDENTIFICATION)):
        times, values = series(chaos.wild.glances, lambda g: g.memory_mb, node)
        memory.plot(times, values, color=f'C{number}', label=node, linewidth=1.2)
    memory.set_xlabel('time at sea, h')
    memory.set_ylabel('resident memory, MB')
    memory.set_ylim(bottom=0.0)
    memory.legend(ncols=3, fontsize='small', loc='lower right')
    seen = [recording.lost_s for recording in chaos.kills.recordings]
    lost.plot(range(1, len(seen) + 1), seen, 'o', markersize=3.5, color='C0')
    lost.axhline(MOST_LOST_S, color='0.4', linewidth=0.8, linestyle='--')
    lost.set_xlabel('kill of the recorder at full load')
    lost.set_ylabel('lost before it, s')
    lost.set_ylim(bottom=0.0)
    for axes in (memory, lost):
        axes.spines[['top', 'right']].set_visible(False)
    return figure
