"""Every way to set up a shadow map, side by side."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Dict, List, Optional

from lightfit.errors import LightfitWarning
from lightfit.messages import Footprint, Matrix, footprint_of, lower_word, matrix_of, optional
from lightfit.result import Samples, Status, samples_of, status_of
from lightfit.v1 import comparison_pb2, matrix_pb2


@dataclasses.dataclass(frozen=True, eq=False)
class ComparedMethod:
    """One method for one light. Figures are None where it has no matrix, and where `note` says so."""

    name: str  # "standard", "focused", ... "lightfit", the fit that the options ask for
    status: Status
    note: str  # empty, or how the method fell back, or why it has no energy
    map_from_world: Optional[Matrix]  # (4, 4), as LightResult.map_from_world
    border: Optional[str]  # what look-ups outside the map find

    # Squared footprints (Chong and Gortler's energy) of the read-back's samples, whatever was
    # minimised, and that over the energy of "lightfit".
    energy: Optional[float]
    energy_ratio: Optional[float]
    footprint: Optional[Footprint]
    foretold_wrong: Optional[float]  # share of the image's pixels, 0 ... 1
    message: comparison_pb2.MethodComparison = dataclasses.field(repr=False)

    @property
    def ok(self) -> bool:
        return self.status.ok

    @classmethod
    def of(cls, message: comparison_pb2.MethodComparison) -> "ComparedMethod":
        return cls(
            name=message.method,
            status=status_of(message.status),
            note=message.note,
            map_from_world=optional(message, "map_from_world", matrix_of),
            border=lower_word(matrix_pb2.Border, message.border, "BORDER_"),
            energy=optional(message, "energy"),
            energy_ratio=optional(message, "energy_ratio"),
            footprint=optional(message, "footprint", footprint_of),
            foretold_wrong=optional(message, "foretold_share"),
            message=message,
        )


@dataclasses.dataclass(frozen=True, eq=False)
class ComparedLight:
    """One light; comparison["sun"]["focused"] is one of its methods."""

    name: str
    samples: Samples
    methods: List[ComparedMethod]  # "lightfit" is the last
    message: comparison_pb2.LightComparison = dataclasses.field(repr=False)

    def __getitem__(self, method: str) -> ComparedMethod:
        for compared in self.methods:
            if compared.name == method:
                return compared
        raise KeyError(method)

    @classmethod
    def of(cls, message: comparison_pb2.LightComparison) -> "ComparedLight":
        methods = [ComparedMethod.of(method) for method in message.methods]
        return cls(message.name, samples_of(message.samples), methods, message)


@dataclasses.dataclass(frozen=True, eq=False)
class ComparedTotal:
    """One method over the lights for which both it and "lightfit" have a matrix."""

    method: str
    lights: int
    failed: int  # lights without a matrix of this method
    mean_energy_ratio: Optional[float]  # geometric mean of ComparedMethod.energy_ratio


@dataclasses.dataclass(frozen=True, eq=False)
class Comparison:
    """In the order of the lights of the call; comparison["sun"] is that of one."""

    lights: List[ComparedLight]
    totals: Dict[str, ComparedTotal]  # by method
    message: comparison_pb2.Comparison = dataclasses.field(repr=False)

    def __getitem__(self, name: str) -> ComparedLight:
        for light in self.lights:
            if light.name == name:
                return light
        raise KeyError(name)

    def __str__(self) -> str:
        """A table: energies over that of "lightfit", and shares of wrong pixels foretold, in per
        cent."""
        lines = []
        for light in self.lights:
            for method in light.methods:
                ratio = "" if method.energy_ratio is None else f"{method.energy_ratio:.3g}x"
                wrong = "" if method.foretold_wrong is None else f"{100 * method.foretold_wrong:.3g}"
                why = method.note if method.ok else str(method.status)
                line = f"{light.name:12} {method.name:16} {ratio:>8} {wrong:>8}  {why}"
                lines.append(line.rstrip())
        return "\n".join(lines)

    @classmethod
    def of(cls, message: comparison_pb2.Comparison) -> "Comparison":
        for text in message.warnings:
            warnings.warn(text, LightfitWarning, stacklevel=4)
        totals = {
            total.method: ComparedTotal(
                total.method,
                total.num_lights,
                total.num_failed,
                optional(total, "mean_energy_ratio"),
            )
            for total in message.totals
        }
        return cls([ComparedLight.of(light) for light in message.lights], totals, message)
