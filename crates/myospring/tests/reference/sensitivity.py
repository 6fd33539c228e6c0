"""Makes sensitivity.json: what SALib says of designs and answers that it made itself.

    pip install SALib==1.6.0
    python sensitivity.py > sensitivity.json

The function is Sobol's g with a = 0, 1, 4.5, 9 and an interaction, of rows from SALib's own samplers.
"""

import json

import numpy as np
from SALib.analyze import morris as morris_analysis
from SALib.analyze import sobol as sobol_analysis
from SALib.sample import morris as morris_sample
from SALib.sample import sobol as sobol_sample

A = np.array([0.0, 1.0, 4.5, 9.0])


def g(x):
    return np.prod((np.abs(4 * x - 2) + A) / (1 + A), axis=1) + x[:, 0] * x[:, 3]


problem = {"num_vars": 4, "names": list("abcd"), "bounds": [[0.0, 1.0]] * 4}
answer = {}
for name, pairs in [("sobol", False), ("sobol_pairs", True)]:
    rows = sobol_sample.sample(problem, 64, calc_second_order=pairs, seed=3)
    answers = g(rows)
    found = sobol_analysis.analyze(problem, answers, calc_second_order=pairs, num_resamples=1000, seed=1)
    answer[name] = {
        "answers": answers.tolist(),
        "first": found["S1"].tolist(),
        "first_confidence": found["S1_conf"].tolist(),
        "total": found["ST"].tolist(),
        "total_confidence": found["ST_conf"].tolist(),
    }
    if pairs:
        upper = np.triu_indices(4, 1)
        answer[name]["pairs"] = found["S2"][upper].tolist()

rows = morris_sample.sample(problem, 40, num_levels=4, seed=5)
answers = g(rows)
found = morris_analysis.analyze(problem, rows, answers, num_levels=4, num_resamples=1000, seed=1)
answer["morris"] = {
    "points": rows.tolist(),
    "answers": answers.tolist(),
    "mean": np.asarray(found["mu"]).tolist(),
    "mean_size": np.asarray(found["mu_star"]).tolist(),
    "confidence": np.asarray(found["mu_star_conf"]).tolist(),
    "spread": np.asarray(found["sigma"]).tolist(),
}
print(json.dumps(answer))
