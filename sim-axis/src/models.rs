use std::fmt;

use crate::audit::InvalidModel;
use crate::model::{AxisModel, AxisModelSpec, LoadSpec, ServoSpec};

/// The axes that a process has of its own. A model with an empty name is that of every axis that no other names; without
/// one, such an axis follows ideally.
#[derive(Clone, Debug, PartialEq)]
pub struct Models {
    named: Vec<AxisModel>,
    of_the_rest: AxisModel,
}

/// Models that cannot be told apart, or cannot be simulated.
#[derive(Clone, Debug, PartialEq)]
pub struct InvalidModels {
    /// Names that several models have.
    pub duplicates: Vec<String>,
    /// Those with invalid fields.
    pub invalid: Vec<InvalidModel>,
}

impl Models {
    /// Takes models as somebody wrote them.
    ///
    /// # Errors
    /// Every name that is there twice and every field that is invalid.
    pub fn new(specs: Vec<AxisModelSpec>) -> Result<Self, InvalidModels> {
        let mut models = Self::default();
        let mut refused = InvalidModels { duplicates: Vec::new(), invalid: Vec::new() };
        let mut names: Vec<String> = Vec::new();
        for spec in specs {
            if names.contains(&spec.axis) {
                refused.duplicates.push(spec.axis.clone());
            }
            names.push(spec.axis.clone());
            match AxisModel::try_from(spec) {
                Ok(model) if model.axis().is_empty() => models.of_the_rest = model,
                Ok(model) => models.named.push(model),
                Err(invalid) => refused.invalid.push(invalid),
            }
        }
        if refused.duplicates.is_empty() && refused.invalid.is_empty() { Ok(models) } else { Err(refused) }
    }

    /// The model of the axis called `name`.
    #[must_use]
    pub fn of(&self, name: &str) -> AxisModel {
        let named = self.named.iter().find(|model| model.axis() == name);
        named.cloned().unwrap_or_else(|| self.of_the_rest.renamed(name))
    }

    /// The servo of the axis called `name`; where no model says what it is, one that is yet to be tuned.
    #[must_use]
    pub fn servo_of(&self, name: &str) -> ServoSpec {
        let model = self.of(name);
        if model.spec().mechanics.load == LoadSpec::Ideal { ServoSpec::UNSET } else { model.spec().servo }
    }

    /// All of them; last, under an empty name, that of the axes without a name here.
    pub fn iter(&self) -> impl Iterator<Item = &AxisModel> {
        self.named.iter().chain([&self.of_the_rest])
    }
}

impl Default for Models {
    /// Every axis follows ideally.
    fn default() -> Self {
        Self { named: Vec::new(), of_the_rest: AxisModel::ideal("") }
    }
}

impl fmt::Display for InvalidModels {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        for name in &self.duplicates {
            write!(f, "{separator}several models are called {name:?}: give every axis one")?;
            separator = "; ";
        }
        for invalid in &self.invalid {
            write!(f, "{separator}{invalid}")?;
            separator = "; ";
        }
        Ok(())
    }
}

impl std::error::Error for InvalidModels {}
