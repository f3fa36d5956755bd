"""Tables and pages of results."""

from mpmfw.report.page import write_report
from mpmfw.report.table import CHOICES, COLUMNS, Column, method_dims, shown, table

__all__ = ["CHOICES", "COLUMNS", "Column", "method_dims", "shown", "table", "write_report"]
