"""Tests of the study layer."""
