"""The best model so far: baseline of the return, and what is kept in the end."""

from __future__ import annotations

import copy
from collections.abc import Callable

import numpy as np
import torch
from scipy import stats
from torch import Tensor

from jfto_planner.policy.compiled_policy import Rollouts
from jfto_planner.policy.network.model import Policy
from jfto_planner.policy.problems import Problems
from jfto_planner.policy.training.config import TrainingConfig

# Sets of evaluation problems of the last challenge, and their first number, which no other has.
SETTLING, UNUSED = 4, 1_000_000

DrawEvaluation = Callable[[int], list[Problems[Tensor]]]


def greedy_outcomes(policy: Policy, batches: list[Problems[Tensor]]) -> list[Rollouts[Tensor]]:
    """Greedy rollouts of every problem of some batches."""
    training = policy.training
    policy.eval()
    with torch.no_grad():
        outcomes = [policy(batch) for batch in batches]
    policy.train(training)
    return outcomes


def greedy_cost(policy: Policy, batches: list[Problems[Tensor]], config: TrainingConfig) -> Tensor:
    """Cost of greedy rollouts of every problem of some batches, (problems,)."""
    outcomes = greedy_outcomes(policy, batches)
    costs = [outcome.cost(config.miss_penalty, config.late_penalty) for outcome in outcomes]
    return torch.cat([cost.squeeze(1) for cost in costs]).double().cpu()


def significantly_better(candidate: Tensor, incumbent: Tensor, significance: float) -> bool:
    """One-sided paired t-test that the candidate's costs are lower on the same problems."""
    if float(candidate.mean()) >= float(incumbent.mean()):
        return False
    difference = np.asarray(candidate - incumbent)
    if np.ptp(difference) == 0:
        return True
    result = stats.ttest_rel(np.asarray(candidate), np.asarray(incumbent), alternative="less")
    return bool(result.pvalue < significance)


class BestModel:
    """θ_BM: a frozen copy of the policy and its costs on the current evaluation problems.

    The problems are redrawn whenever it is replaced, so that it is not fitted to them.
    """

    def __init__(self, policy: Policy, config: TrainingConfig, draw: DrawEvaluation) -> None:
        self.model = copy.deepcopy(policy).eval()
        self.config = config
        self.draw = draw
        self.draws = 0
        self._measure()

    def challenge(self, policy: Policy) -> tuple[float, bool]:
        """Mean greedy cost of a policy, and whether it took the place of the best model."""
        costs = greedy_cost(policy, self.problems, self.config)
        better = significantly_better(costs, self.costs, self.config.significance)
        if better:
            self.model.load_state_dict(policy.state_dict())
            self.draws += 1
            self._measure()
        return float(costs.mean()), better

    def settle(self, policy: Policy) -> bool:
        """The last challenge, on several times as many problems that neither has met."""
        batches = [batch for number in range(SETTLING) for batch in self.draw(UNUSED + number)]
        better = significantly_better(
            greedy_cost(policy, batches, self.config),
            greedy_cost(self.model, batches, self.config),
            self.config.significance,
        )
        if better:
            self.model.load_state_dict(policy.state_dict())
        return better

    def restore(self, state: dict[str, Tensor], draws: int) -> None:
        """Continue from a checkpoint."""
        self.model.load_state_dict(state)
        self.draws = draws
        self._measure()

    def _measure(self) -> None:
        self.problems = self.draw(self.draws)
        self.costs = greedy_cost(self.model, self.problems, self.config)
