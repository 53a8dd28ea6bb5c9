"""Friction parameters of a contact from its measured hysteresis loop.

    import mindahl
    result = mindahl.fit(displacement, force, normal_load=50)   # arrays, [m] and [N]
    result.sigma.value, result.slip_force.interval, result.adequacy.verdict
    print(result)

fit() fits a record or several, track() every cycle of a long one, batch() many files each on its own; plan()
predicts the errors of a measurement, contact() the force from materials, convert() writes a contact as
another law; command() runs any command of the program. simulate() and ContactState compute the force of
a contact, along excitation() or any motion; read_csv() reads a record as the program does, read_mat()
and read_hdf5() those of other programs; FitResult.load() reads a saved result. docs/python.md has them with
examples.
"""

from ._batch import BatchTable, batch
from ._commands import Conversion, command, contact, convert, excitation, plan, simulate
from ._fit import fit
from ._mindahl import ContactState, InputError, Record, __version__
from ._readers import read_hdf5, read_mat
from ._records import read_csv
from ._result import FitResult, FittedRecord, FitWarning, Parameter, Report, Section
from ._track import CycleTable, track

for _public in (ContactState, InputError, Record):
    _public.__module__ = __name__

__all__ = [
    "BatchTable", "ContactState", "Conversion", "CycleTable", "FitResult", "FitWarning",
    "FittedRecord", "InputError", "Parameter", "Record",
    "Report", "Section", "__version__", "batch", "command", "contact", "convert", "excitation", "fit",
    "plan", "read_csv", "read_hdf5", "read_mat", "simulate", "track",
]
