"""Pressure of a unilateral contact under a load or an approach."""
