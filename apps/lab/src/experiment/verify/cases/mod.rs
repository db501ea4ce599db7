//! All hard cases, grouped by their difficulty.

mod boxes;
mod build;
mod chaos;
mod copies;
mod corners;
mod energies;
mod fields;
mod incidence;
mod input;
mod listener;
mod open;
mod scale;
mod source;
mod tangents;
mod thin;
mod users;

use super::Case;

/// Returns every hard case, in the order of the report.
pub fn all() -> Vec<Case> {
    [
        incidence::cases,
        corners::cases,
        thin::cases,
        tangents::cases,
        source::cases,
        listener::cases,
        scale::cases,
        chaos::cases,
        open::cases,
        boxes::cases,
        fields::cases,
        users::cases,
        copies::cases,
        energies::cases,
        input::cases,
    ]
    .iter()
    .flat_map(|cases| cases())
    .collect()
}

#[cfg(test)]
mod tests {
    use super::all;

    /// Protects `--case`: the names of the cases are unique.
    #[test]
    fn names_are_unique() {
        let mut names: Vec<String> = all().into_iter().map(|case| case.name).collect();
        let count = names.len();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), count);
    }
}
