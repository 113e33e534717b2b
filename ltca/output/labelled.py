"""Labelled arrays without xarray, whose import with pandas takes half a second: what commands write, draw on pages, and hand on.

They have the few names of xarray that pages read, so that either serves; `LabelledDataset.to_xarray` gives the dataset itself.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    import xarray as xr

    Labelled: TypeAlias = "LabelledDataset | xr.Dataset"
    """What pages read."""


@dataclass(frozen=True, slots=True, eq=False)
class LabelledArray:
    """Values with names of their axes.

    Attributes
    ----------
    dims : tuple of str
        Names of the axes.
    values : array
        As many axes.
    attrs : dict
        What is told of them, units among it.
    """

    dims: tuple[str, ...]
    values: NDArray[Any]
    attrs: dict[str, Any] = field(default_factory=dict)

    def __float__(self) -> float:
        """The one number there is."""
        return float(self.values)

    def transpose(self, *dims: str) -> LabelledArray:
        """Return the same with its axes in another order."""
        return replace(self, dims=dims, values=self.values.transpose([self.dims.index(name) for name in dims]))


@dataclass(frozen=True, slots=True, eq=False)
class LabelledDataset:
    """Labelled arrays that share dimensions.

    Attributes
    ----------
    variables : dict of str to LabelledArray
        All of them, coordinates among them.
    coordinates : tuple of str
        Which are places, not results.
    attrs : dict
        What is told of all.
    """

    variables: dict[str, LabelledArray]
    coordinates: tuple[str, ...]
    attrs: dict[str, Any]

    @classmethod
    def build(
        cls, data: Mapping[str, tuple[Any, ...]], coords: Mapping[str, Any], attrs: Mapping[str, Any]
    ) -> LabelledDataset:
        """Return a dataset of what `xarray.Dataset` takes: dimensions, values and attributes, or the values of a dimension."""
        given = {name: ((name,), each) if not isinstance(each, tuple) else each for name, each in coords.items()}
        variables = {
            name: LabelledArray(tuple(dims), np.asarray(values), dict(*told))
            for name, (dims, values, *told) in {**data, **given}.items()
        }
        return cls(variables, tuple(given), dict(attrs))

    @classmethod
    def of(cls, dataset: xr.Dataset) -> LabelledDataset:
        """Return what an xarray dataset holds."""
        variables = {
            str(name): LabelledArray(tuple(map(str, each.dims)), each.values, dict(each.attrs))
            for name, each in dataset.variables.items()
        }
        return cls(variables, tuple(map(str, dataset.coords)), dict(dataset.attrs))

    def to_xarray(self) -> xr.Dataset:
        """Return the dataset of xarray, whose arrays are the same."""
        import xarray as xr

        given = {name: (each.dims, each.values, dict(each.attrs)) for name, each in self.variables.items()}
        data = {name: each for name, each in given.items() if name not in self.coordinates}
        return xr.Dataset(data, coords={name: given[name] for name in self.coordinates}, attrs=dict(self.attrs))

    @property
    def sizes(self) -> dict[str, int]:
        """Sizes of the dimensions, in the order in which the arrays have them."""
        return {
            name: size
            for each in self.variables.values()
            for name, size in zip(each.dims, each.values.shape, strict=True)
        }

    @property
    def data_vars(self) -> dict[str, LabelledArray]:
        """The arrays without the coordinates."""
        return {name: each for name, each in self.variables.items() if name not in self.coordinates}

    def __getitem__(self, name: str) -> LabelledArray:
        return self.variables[name]

    def __contains__(self, name: object) -> bool:
        return name in self.variables

    def isel(self, *, case: int) -> LabelledDataset:
        """Return one case, without its dimension."""
        chosen = {
            name: replace(
                each,
                dims=tuple(dim for dim in each.dims if dim != "case"),
                values=each.values[(slice(None),) * each.dims.index("case") + (case,)],
            )
            if "case" in each.dims
            else each
            for name, each in self.variables.items()
        }
        return replace(self, variables=chosen)
