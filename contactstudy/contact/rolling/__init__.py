"""Stick and slip under Coulomb friction, in steady rolling and in shifts."""
