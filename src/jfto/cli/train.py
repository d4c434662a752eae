"""jfto train."""

from __future__ import annotations

from pathlib import Path

import click

from jfto.cli.options import PATH


@click.command("train")
@click.argument("config", type=PATH)
@click.option(
    "-o",
    "--out",
    type=PATH,
    metavar="DIR",
    default=Path("training"),
    show_default=True,
    help="Checkpoint, log and weights; a run that was stopped there goes on.",
)
@click.option(
    "--device",
    type=click.Choice(["auto", "cpu", "cuda"]),
    default="auto",
    show_default=True,
    help="auto: a GPU where there is one.",
)
@click.option("--threads", type=click.IntRange(1), metavar="N", help="CPU threads; default: all.")
def command(config: Path, out: Path, device: str, threads: int | None) -> int:
    """Train the learned planner RL-TP as CONFIG says.

    Stop it at any time: the same command goes on from the last checkpoint with the same curve.
    Several processes share the work under torchrun.

    \b
    Example:  jfto train config/train_rl_tp.yaml --out training
              torchrun --nproc_per_node=2 -m jfto train config/train_rl_tp.yaml
    """
    from jfto_planner.policy.training.config import read_training

    settings = read_training(config)

    import torch

    from jfto.cli.failure import EXIT_INTERRUPTED
    from jfto.console.stages import show_stages
    from jfto_msgs_py.errors import InputError
    from jfto_planner.policy.network.model import arrays_of
    from jfto_planner.policy.training.trainer import Progress as Step
    from jfto_planner.policy.training.trainer import Trainer
    from jfto_planner.policy.weights import NAME, save_weights

    if device == "cuda" and not torch.cuda.is_available():
        raise InputError("--device cuda: torch sees no GPU. Use --device cpu or auto.")
    if device == "auto":
        device = "cuda" if torch.cuda.is_available() else "cpu"
    if threads:
        torch.set_num_threads(threads)
    trainer = Trainer(settings, out, device)
    with show_stages(quiet=trainer.workers.rank != 0) as progress:
        progress.begin("training", f"{settings.total_steps} steps")

        def report(step: Step) -> None:
            row = step.row
            progress.advance(
                step.step / step.total,
                f"step {step.step}/{step.total}  W={row['waypoints']:.0f} A={row['uavs']:.0f}  "
                f"length {row['length']:.2f}  feasible {100 * row['feasible']:.0f} %",
            )

        try:
            best = trainer.run(report)
        except KeyboardInterrupt:
            click.echo(f"\nStopped. The same command goes on from {out}.", err=True)
            return EXIT_INTERRUPTED
    if trainer.workers.rank == 0:
        digest = save_weights(arrays_of(best), best.shape, out / NAME)
        click.echo(f"Weights     {out / NAME}  sha256 {digest[:12]}…")
    return 0
