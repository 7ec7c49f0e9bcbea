"""Results for others' tools: fields as VTK for ParaView, lines and tables as CSV."""

from contactstudy.export.table import to_csv, to_table
from contactstudy.export.vtk import to_vtk

__all__ = ["to_csv", "to_table", "to_vtk"]
