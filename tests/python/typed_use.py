"""What a user writes, for mypy; test_types.py says what it must find wrong."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

import mindahl

displacement = np.linspace(0.0, 1e-6, 10)
force: NDArray[np.float64] = mindahl.simulate(displacement, sigma=4e7, slip_force=40.0)
state = mindahl.ContactState(sigma=4e7, slip_force=40.0)
moved: float = state.move(1e-7)
planned: mindahl.Report = mindahl.plan((displacement, force), want={"alpha": 0.01, "slip_force": "1%"})
studied: str = mindahl.command("tradeoff", friction=(0.3, 0.01), normal_load=50.0,
                                contact_radius=1e-4, compliance=4e-11, tolerance="1%").to_json()
valid: dict[str, object] = mindahl.command("validate", cases=2).to_dict()
runs: mindahl.BatchTable = mindahl.batch(["run1.csv", (displacement, force)], model="mindlin", strict=True)
table: str = runs.to_csv()


def fitted() -> tuple[float, float | None]:
    result = mindahl.fit(displacement, force, normal_load=[(50.0, 0.5)], fix={"alpha": 1 / 3})
    low, _ = result.slip_force.interval
    friction = result.contact.friction_coefficient.value
    cycles = mindahl.track(displacement, force, average=2)
    print(result, friction, cycles["sigma"].mean(), [warning.code for warning in result.warnings])
    return result.slip_force.value or 0.0, low
