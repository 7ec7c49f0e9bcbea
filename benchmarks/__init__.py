"""Programs that take hours or peers: finite elements, random cases, faults, changed signs, speed."""
