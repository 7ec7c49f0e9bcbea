"""Results for others' tools: fields as VTK for ParaView, everything for MATLAB, lines and tables as CSV."""

from contactstudy.export.matlab import to_mat
from contactstudy.export.table import to_csv, to_table
from contactstudy.export.vtk import to_vtk

__all__ = ["to_csv", "to_mat", "to_table", "to_vtk"]
